//! `vm cycles`: the profile of a function does not depend on the tracer.
//!
//! Without the thumb target or QEMU these tests print SKIPPED.

use host_sim::cycles::{Argument, Profile, ProfileError, Tracer, of_image};
use host_sim::target::STM32F405;
use std::path::Path;
use std::time::Duration;
use system_tests::{build, skip};

/// Profile of a direct call of libm's `exp(1.5)` in `f64`. The image is not the stimulator's, whose
/// statics are in the upper RAM that a direct call needs.
fn profile(image: &Path, machine: &str, tracer: Tracer) -> Result<Profile, ProfileError> {
    let (function, arguments) = ("libm::math::exp::exp", [Argument::Double(1.5)]);
    of_image(image, function, Some(&arguments), machine, tracer, Duration::from_secs(60))
}

#[test]
fn the_plugin_and_the_log_show_the_same_execution() {
    let profiles =
        build(STM32F405, "golden").map_err(|error| error.to_string()).and_then(|image| {
            [Tracer::Plugin, Tracer::Log]
                .map(|tracer| {
                    profile(&image, STM32F405.machine, tracer).map_err(|error| error.to_string())
                })
                .into_iter()
                .collect::<Result<Vec<_>, _>>()
        });
    let profiles = match profiles {
        Ok(profiles) => profiles,
        Err(reason) => return skip(&reason),
    };
    assert_eq!(profiles[0].calls, profiles[1].calls);
    assert_eq!(profiles[0].executions, profiles[1].executions);
    // Another estimator and compiler gave 3748 cycles.
    let typical = profiles[0].calls[0].cycles[1];
    assert!((3400..=4100).contains(&typical), "{typical}");
}

#[test]
fn an_unknown_machine_is_reported_by_the_emulator() {
    let image = match build(STM32F405, "golden") {
        Ok(image) => image,
        Err(reason) => return skip(&reason.to_string()),
    };
    let error = profile(&image, "no-such-machine", Tracer::Auto).expect_err("no such machine");
    let message = error.to_string();
    if message.contains("apt-get install qemu-system-arm") {
        return skip(&message);
    }
    assert!(message.contains("unsupported machine type"), "{message}");
}
