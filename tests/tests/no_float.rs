//! The fixed-point tick uses no floating point, in hardware or software, and no 64-bit division:
//! checked in the images for all three cores.
//!
//! Without a target's library these tests print SKIPPED.

use host_sim::cycles::{Reached, reachable};
use host_sim::target::{Board, CORTEX_M0, CORTEX_M3, STM32F405};
use system_tests::{build, skip};

/// Names of functions for software floating point or 64-bit division.
fn forbidden(name: &str) -> bool {
    let library = |prefixes: &[&str]| prefixes.iter().any(|prefix| name.contains(prefix));
    // __aeabi_f2d and the like, __aeabi_d2iz, __aeabi_i2f, __aeabi_fadd, __aeabi_dcmplt ...
    let float = name.strip_prefix("__aeabi_").is_some_and(|rest| {
        rest.starts_with(['f', 'd']) || rest.contains("2f") || rest.contains("2d")
    });
    float
        || library(&["float::", "libm::", "ldivmod", "__udivdi3", "__divdi3", "__umoddi3"])
        || library(&["addsf3", "adddf3", "mulsf3", "muldf3", "udivmod", "specialized_div_rem"])
}

fn steps(board: Board, function: &str) -> Option<Reached> {
    match build(board, "step") {
        Ok(image) => Some(reachable(&image, function).expect("the step in the image")),
        Err(reason) => {
            skip(&reason.to_string());
            None
        }
    }
}

#[test]
fn no_floating_point_or_long_division_is_reachable_from_the_tick() {
    for board in [STM32F405, CORTEX_M3, CORTEX_M0] {
        for function in ["step_continuous_fixed", "step_fes_fixed", "step_discrete_fixed"] {
            let Some(reached) = steps(board, function) else { return };
            let what = format!("{function} on {}", board.triple);
            assert!(reached.functions.len() > 3, "{what}: {:?}", reached.functions);
            assert!(reached.indirect.is_empty(), "{what}: {:?}", reached.indirect);
            assert!(reached.floating_point.is_empty(), "{what}: {:?}", reached.floating_point);
            let found: Vec<_> = reached.functions.iter().filter(|name| forbidden(name)).collect();
            assert!(found.is_empty(), "{what}: {found:?}");
        }
    }
}

#[test]
fn forbidden_functions_are_detected() {
    // The program as a whole builds muscles, which needs both.
    let Some(reached) = steps(CORTEX_M3, "main") else { return };
    let found = reached.functions.iter().filter(|name| forbidden(name)).count();
    assert!(found >= 5, "{:?}", reached.functions);
    let Some(reached) = steps(STM32F405, "main") else { return };
    assert!(!reached.floating_point.is_empty());
}
