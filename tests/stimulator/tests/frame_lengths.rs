//! Frames of every length: each comes out of the receiver as it went into the encoder, whatever
//! stands on the line before and after it, and whatever of that is lost.

use firmware::link::{
    LinkError, MOST_CONTENT, MOST_FRAME, NO_SESSION, Receiver, SessionNumber, encode,
};
use serde::ser::{Serialize, SerializeTuple, Serializer};

/// A content of just these bytes: a tuple has no length of its own.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

/// What the receiver makes of bytes: of each frame, its session, sequence number and content, or
/// why it is none.
type Received = Result<(SessionNumber, u16, Vec<u8>), LinkError>;

fn received(receiver: &mut Receiver, session: SessionNumber, bytes: &[u8]) -> Vec<Received> {
    let mut all = Vec::new();
    for &byte in bytes {
        if let Some(one) = receiver.push(byte, session) {
            all.push(one.map(|frame| (frame.session, frame.sequence, frame.content.to_vec())));
        }
    }
    all
}

/// A byte, of its place and of the length.
type Fill = fn(usize, usize) -> u8;

/// COBS counts bytes between zeros up to 254: runs around that, and zeros where a run begins or
/// ends.
fn fills() -> Vec<(&'static str, Fill)> {
    vec![
        ("zeros", |_, _| 0),
        ("ones", |_, _| 1),
        ("ff", |_, _| 0xff),
        ("zero first", |index, _| u8::from(index != 0)),
        ("zero last", |index, length| u8::from(index + 1 != length)),
        ("zero at both ends", |index, length| u8::from(index != 0 && index + 1 != length)),
        ("alternating from 0", |index, _| (index % 2) as u8),
        ("alternating from 1", |index, _| ((index + 1) % 2) as u8),
        ("runs of 253", |index, _| u8::from(index % 254 != 253)),
        ("runs of 254", |index, _| u8::from(index % 255 != 254)),
        ("runs of 255", |index, _| u8::from(index % 256 != 255)),
        ("a run of 254 at the end", |index, length| u8::from(index + 255 != length)),
        ("a run of 250 at the end", |index, length| u8::from(index + 251 != length)),
        ("counting", |index, _| index as u8),
        ("mixed", |index, _| (index.wrapping_mul(0x9E37_79B1) >> 9) as u8),
    ]
}

/// Sessions and sequence numbers with bytes that are 0, and without any.
const NUMBERS: [(SessionNumber, u16); 6] =
    [(NO_SESSION, 0), (9, 7), (9, 0x0107), (0x1234_5679, 0x0101), (u32::MAX, 0xffff), (1, 0x0100)];

/// Each length with each fill: one zero, at the end; and it and the frame after it arrive.
#[test]
fn a_frame_of_any_length_and_content_arrives_and_so_does_the_next() {
    let mut receiver = Receiver::new();
    let mut longest = 0;
    for (name, fill) in fills() {
        for length in 0..=MOST_CONTENT {
            let content: Vec<u8> = (0..length).map(|index| fill(index, length)).collect();
            for (session, sequence) in NUMBERS {
                let what = || format!("{name}, {length} bytes, session {session}, {sequence}");
                let next = sequence.wrapping_add(1);
                let mut line = encode(session, sequence, &Raw(&content)).expect("a frame").to_vec();
                assert!(line.len() <= MOST_FRAME, "{}", what());
                assert_eq!(
                    line.iter().position(|byte| *byte == 0),
                    Some(line.len() - 1),
                    "{}",
                    what()
                );
                longest = longest.max(line.len());
                line.extend(encode(session, next, &Raw(&[1, 0, 2])).expect("a frame"));
                let all = received(&mut receiver, session, &line);
                let expected =
                    [Ok((session, sequence, content.clone())), Ok((session, next, vec![1, 0, 2]))];
                assert_eq!(all, expected, "{}", what());
            }
        }
    }
    assert_eq!(longest, MOST_FRAME);
    assert!(encode(9, 7, &Raw(&[1; MOST_CONTENT + 1])).is_none());
}

/// The case that was reported: a slice of so many ones, with its length before it.
#[test]
fn slices_that_end_a_run_of_254_arrive() {
    for length in [248, 502] {
        let ones = vec![1_u8; length];
        let line = encode(9, 7, &ones.as_slice()).expect("a frame");
        let all = received(&mut Receiver::new(), 9, &line);
        assert_eq!(all.len(), 1, "{length}");
        let (_, _, content) = all[0].clone().expect("a whole frame");
        let slice = postcard::from_bytes::<heapless::Vec<u8, 512>>(&content).expect("a slice");
        assert_eq!(slice.as_slice(), ones);
    }
}

/// Nothing longer than the longest message is a frame, though there be no more bytes than in a
/// frame with its zero.
#[test]
fn a_frame_of_a_longer_message_than_any_is_too_long() {
    let mut receiver = Receiver::new();
    let most = [&[0xff_u8; MOST_FRAME - 1][..], &[0]].concat();
    assert_ne!(received(&mut receiver, 9, &most), [Err(LinkError::TooLong)]);
    let more = [&[0xff_u8; MOST_FRAME][..], &[0]].concat();
    assert_eq!(received(&mut receiver, 9, &more), [Err(LinkError::TooLong)]);
    let good = encode(9, 7, &Raw(&[3])).expect("a frame");
    assert_eq!(received(&mut receiver, 9, &good), [Ok((9, 7, vec![3]))]);
}

/// Any byte of three frames lost, with and without the line's noticing it: what arrives was sent,
/// and the frames that it was not lost from arrive, but for the one after a lost end.
#[test]
fn a_lost_byte_costs_the_frames_that_it_was_lost_from() {
    let content = [vec![1; 247], vec![0; 20], vec![2; 250], vec![0; 3]].concat();
    let contents = [&content[..247], &content[..], &content[247..300]];
    let frames: Vec<Vec<u8>> = (0x0101..)
        .zip(contents)
        .map(|(sequence, one)| encode(9, sequence, &Raw(one)).expect("a frame").to_vec())
        .collect();
    let line = frames.concat();
    let sent: Vec<Received> =
        (0x0101..).zip(contents).map(|(sequence, one)| Ok((9, sequence, one.to_vec()))).collect();
    for notices in [true, false] {
        for place in 0..line.len() {
            let mut receiver = Receiver::new();
            let mut all = received(&mut receiver, 9, &line[..place]);
            if notices {
                receiver.lost();
            }
            all.extend(received(&mut receiver, 9, &line[place + 1..]));
            let (mut first, mut begins) = (0, 0);
            while begins + frames[first].len() <= place {
                begins += frames[first].len();
                first += 1;
            }
            let is_end = line[place] == 0;
            let costs = if is_end { first..(first + 2).min(3) } else { first..first + 1 };
            let whole: Vec<Received> = all.iter().filter(|one| one.is_ok()).cloned().collect();
            let expected: Vec<Received> = (0..3)
                .filter(|index| !costs.contains(index))
                .map(|index| sent[index].clone())
                .collect();
            assert_eq!(whole, expected, "byte {place}, noticed: {notices}");
            // The last one's end, and nothing after it: that is still to come.
            let broken = usize::from(place + 1 < line.len());
            assert_eq!(all.len() - whole.len(), broken, "byte {place}, noticed: {notices}");
        }
    }
}

/// A byte that was lost where its value would not have been missed: the frame is none all the same.
#[test]
fn a_frame_with_a_loss_in_it_is_none_whatever_its_bytes() {
    let line = encode(9, 7, &Raw(&[3, 0, 5])).expect("a frame");
    for place in 0..line.len() {
        let mut receiver = Receiver::new();
        let mut all = received(&mut receiver, 9, &line[..place]);
        receiver.lost();
        all.extend(received(&mut receiver, 9, &line[place..]));
        assert_eq!(all, [Err(LinkError::Malformed)], "before byte {place}");
    }
    // One whose value could be guessed.
    let line = encode(9, 7, &Raw(&[3, 0, 0xff])).expect("a frame");
    let place = line.iter().position(|byte| *byte == 0xff).expect("it is there");
    let mut receiver = Receiver::new();
    assert_eq!(received(&mut receiver, 9, &line[..place]), []);
    receiver.lost();
    assert_eq!(received(&mut receiver, 9, &line[place + 1..]), [Err(LinkError::Malformed)]);
    // A whole frame is lost, but for its end.
    let mut receiver = Receiver::new();
    receiver.lost();
    assert_eq!(received(&mut receiver, 9, &[0]), [Err(LinkError::Malformed)]);
    assert_eq!(received(&mut receiver, 9, &line), [Ok((9, 7, vec![3, 0, 0xff]))]);
}
