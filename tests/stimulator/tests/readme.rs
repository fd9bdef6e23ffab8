//! Numbers of the firmware's README that follow from its types.

use firmware::link::{
    Answer, MOST_ROWS, Message, Request, RowInputs, RowOutputs, Traced, VERSION, encode,
};
use firmware::{MUSCLES, TYPES};

const README: &str = include_str!("../../../firmware/README.md");

/// Bytes per second of 460,800 Bd: a start bit, eight data bits and a stop bit.
const LINE: usize = 460_800 / 10;

/// Rows of the middle of a session of minutes; no word of them is zero.
#[test]
fn the_link_limits_rows_per_second() {
    let (session, sequence, first) = (0x1234_5678, 1000, 100_000);
    let input = RowInputs { activation: 0.3, path_length: 0.16, stimulation_frequency: 20.1 };
    let rows = std::iter::repeat_n([input; MUSCLES], MOST_ROWS).collect();
    let to_device = encode(session, sequence, &Request::Rows { first, rows });
    let output =
        RowOutputs { force: 123.4, fascicle_length: 1.1, fascicle_velocity: -0.7, status: 0 };
    let traced = Traced { row: first, outputs: [output; MUSCLES] };
    let traces = Message::Traces(std::iter::repeat_n(traced, MOST_ROWS).collect());
    let done = Message::Answer { to: sequence, answer: Answer::Done };
    let bytes = |message: &Message<'_>| encode(session, sequence, message).expect("room").len();

    // Both directions at once: the busier one limits.
    let busier = to_device.expect("room").len().max(bytes(&traces) + bytes(&done));
    let rows_per_second = (LINE * MOST_ROWS / busier) as f64;
    let rounded = (rows_per_second / 10.0).round() * 10.0;
    let sentence = format!("at most {rounded} rows/s");
    assert!(README.contains(&sentence), "{rows_per_second}: not in firmware/README.md: {sentence}");
}

#[test]
fn the_readme_says_what_a_device_takes() {
    let muscles = format!("| muscles | {MUSCLES}, each of {TYPES} fibre types, in `f32` only");
    assert!(README.contains(&muscles), "{muscles}");
    assert!(README.contains(&format!("version {VERSION} of the protocol")), "version {VERSION}");
}
