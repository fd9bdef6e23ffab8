//! A host that does not wait: what it sends is answered in order, and nothing is lost for want of
//! room.

use firmware::MUSCLES;
use firmware::link::{Answer, Message, NO_SESSION, Receiver, Request, RowInputs, encode};
use std::io::Read;
use stimulator_tests::host::{Host, booted};

/// Sequence numbers of all answers, with the answers; and numbers of all rows that were traced.
fn heard(host: &mut Host) -> (Vec<(u16, String)>, Vec<u32>) {
    let (mut byte, mut receiver) = ([0], Receiver::new());
    let (mut answers, mut rows) = (Vec::new(), Vec::new());
    while host.line().read(&mut byte).is_ok() {
        let Some(frame) = receiver.push(byte[0], NO_SESSION) else { continue };
        let frame = frame.expect("a whole frame");
        match postcard::from_bytes(frame.content).expect("a message") {
            Message::Answer { to, answer: Answer::Report(_) } => {
                answers.push((to, "Report".into()))
            }
            Message::Answer { to, answer } => answers.push((to, format!("{answer:?}"))),
            Message::Traces(traced) => rows.extend(traced.into_iter().map(|traced| traced.row)),
            other => panic!("{other:?}"),
        }
    }
    (answers, rows)
}

/// Those that the tick answers, and those that the link answers at once.
#[test]
fn requests_that_do_not_wait_are_answered_in_order() {
    let mut host = booted();
    let (session, first) = host.session();
    let requests = [(Request::Report, "Report"), (Request::KeepAlive, "Done")];
    let mut expected = Vec::new();
    for (sequence, (request, answer)) in (first..).zip(requests.iter().cycle().take(20)) {
        host.send_raw(&encode(session, sequence, request).expect("a frame"));
        expected.push((sequence, (*answer).to_owned()));
    }
    assert_eq!(heard(&mut host).0, expected);
}

/// More than the device has room to say: the rows wait, and each is traced once.
#[test]
fn outputs_wait_for_a_host_that_does_not_read() {
    const MESSAGES: u16 = 9;
    let mut host = booted();
    let (session, sequence) = host.session();
    for index in 0..MESSAGES {
        let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]; 8]).expect("room");
        let request = Request::Rows { first: 8 * u32::from(index), rows };
        host.send_raw(&encode(session, sequence + index, &request).expect("a frame"));
        (0..10).for_each(|_| host.line().tick());
    }
    let (answers, rows) = heard(&mut host);
    let expected = (sequence..sequence + MESSAGES).map(|to| (to, "Done".to_owned()));
    assert_eq!(answers, expected.collect::<Vec<_>>());
    assert_eq!(rows, (0..8 * u32::from(MESSAGES)).collect::<Vec<_>>());
}
