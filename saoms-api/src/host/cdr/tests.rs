use proptest::prelude::*;

use super::*;
use crate::host::Arguments;
use crate::{Bounded, Message};

#[derive(Clone, Debug, PartialEq, Message)]
struct Everything {
    flag: bool,
    small: i8,
    short: u16,
    number: i32,
    long: u64,
    single: f32,
    double: f64,
    text: String,
    bytes: Vec<u8>,
    floats: Vec<f64>,
    texts: Vec<String>,
    nested: Vec<Pair>,
    kind: Kind,
    nothing: Empty,
    flags: Vec<bool>,
}

#[derive(Clone, Debug, PartialEq, crate::Field)]
struct Pair {
    small: u8,
    wide: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, crate::Field)]
#[field(repr = "i16")]
enum Kind {
    Below = -300,
    Zero = 0,
    One,
}

#[derive(Clone, Debug, PartialEq, Message)]
struct Empty;

fn bytes<F: Field>(value: &F) -> Vec<u8> {
    let bytes = encode(value);
    let mut again = vec![9; 100];
    encode_into(value, &mut again);
    assert_eq!(bytes, again);
    assert_eq!(bytes[..4], [0, 1, 0, 0]);
    bytes[4..].to_vec()
}

#[test]
fn values_have_the_bytes_of_ros_2() {
    assert_eq!(bytes(&true), [1]);
    assert_eq!(bytes(&-2_i16), [0xfe, 0xff]);
    assert_eq!(bytes(&1.0_f32), [0, 0, 0x80, 0x3f]);
    assert_eq!(bytes(&"hi".to_owned()), [3, 0, 0, 0, b'h', b'i', 0]);
    assert_eq!(bytes(&String::new()), [1, 0, 0, 0, 0]);
    assert_eq!(bytes(&vec![1_u8, 2]), [2, 0, 0, 0, 1, 2]);
    assert_eq!(bytes(&Vec::<f64>::new()), [0, 0, 0, 0]);
    // The elements are aligned, not the length.
    assert_eq!(bytes(&vec![1_u64]), [1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(bytes(&Pair { small: 1, wide: -1 }), [1, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255]);
    assert_eq!(bytes(&Kind::Below), [0xd4, 0xfe]);
    assert_eq!(bytes(&Kind::One), [1, 0]);
    assert_eq!(bytes(&Empty), [0]);
    assert_eq!(bytes(&()), [0]);
}

#[test]
fn arguments_follow_each_other() {
    let mut writer = Writer::new();
    Arguments::write(&(1_u8, 2_u32, "x".to_owned()), &mut writer);
    assert_eq!(writer.bytes()[4..], [1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, b'x', 0]);
    let mut reader = Reader::new(writer.bytes()).unwrap();
    assert_eq!(Arguments::read(&mut reader), Ok((1_u8, 2_u32, "x".to_owned())));
    assert_eq!(reader.finish(), Ok(()));
}

/// The error of decoding these bytes, without the header.
fn refused<F: Field + std::fmt::Debug>(body: &[u8]) -> String {
    decode::<F>(&[&HEADER, body].concat()).unwrap_err().to_string()
}

#[test]
fn wrong_bytes_are_refused_with_their_place() {
    assert_eq!(
        decode::<bool>(&[]).unwrap_err().to_string(),
        "byte 0: found 0 bytes, expected at least the header of 4"
    );
    assert_eq!(
        decode::<bool>(&[0, 0, 0, 0, 1]).unwrap_err().to_string(),
        "byte 0: found the header 00 00, expected 00 01 (plain CDR, little endian)"
    );
    assert_eq!(refused::<bool>(&[]), "byte 4: found 0 more bytes, expected 1");
    assert_eq!(refused::<bool>(&[2]), "byte 4: found 2, expected 0 or 1 for a bool");
    assert_eq!(refused::<bool>(&[1, 0]), "byte 5: found 1 more bytes, expected the end");
    assert_eq!(refused::<u32>(&[1, 2, 3]), "byte 4: found 3 more bytes, expected 4");
    assert_eq!(refused::<Pair>(&[1, 0, 0]), "byte 7: found 0 more bytes, expected 8");
    assert_eq!(refused::<Kind>(&[7, 0]), "byte 4: found 7, expected a constant of Kind");
    assert_eq!(refused::<String>(&[2, 0, 0, 0, b'x', b'x']), "byte 9: the string does not end with NUL");
    assert_eq!(refused::<String>(&[3, 0, 0, 0, b'x', 0xff, 0]), "byte 9: the string is not UTF-8");
    assert_eq!(refused::<String>(&[255; 8]), "byte 4: found the length 4294967295, but only 4 bytes are left");
    assert_eq!(
        refused::<Vec<u64>>(&[2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        "byte 4: found the length 2, but only 9 bytes are left"
    );
    assert_eq!(refused::<Vec<()>>(&[255; 12]), "byte 4: found the length 4294967295, but only 8 bytes are left");
    assert_eq!(
        refused::<Vec<Vec<Vec<u8>>>>(&[255; 40]),
        "byte 4: found the length 4294967295, but only 36 bytes are left"
    );
    assert_eq!(refused::<[u16; 3]>(&[1, 2, 3]), "byte 4: found 3 more bytes, expected 6");
    assert_eq!(refused::<[Kind; 2]>(&[0, 0, 7, 0]), "byte 6: found 7, expected a constant of Kind");
    assert_eq!(refused::<Vec<[u8; 9]>>(&[1, 0, 0, 0, 1]), "byte 4: found the length 1, but only 1 bytes are left");
    assert_eq!(
        refused::<Bounded<Vec<u8>, 2>>(&[3, 0, 0, 0, 1, 2, 3]),
        "byte 4: found a length of 3, expected at most 2"
    );
    assert_eq!(
        refused::<Bounded<String, 0>>(&[2, 0, 0, 0, b'x', 0]),
        "byte 4: found a length of 1, expected at most 0"
    );
}

#[test]
fn what_other_writers_do_is_read() {
    // Options in the header, and a length of zero for the empty string.
    assert_eq!(decode(&[0, 1, 0, 3, 7]), Ok(7_u8));
    assert_eq!(decode(&[0, 1, 0, 0, 0, 0, 0, 0]), Ok(String::new()));
}

fn everything() -> impl Strategy<Value = Everything> {
    let pair = (any::<u8>(), any::<i64>()).prop_map(|(small, wide)| Pair { small, wide });
    let kind = prop_oneof![Just(Kind::Below), Just(Kind::Zero), Just(Kind::One)];
    let scalars = (any::<bool>(), any::<i8>(), any::<u16>(), any::<i32>(), any::<u64>(), any::<f32>(), any::<f64>());
    let lists = (
        any::<String>(),
        any::<Vec<u8>>(),
        proptest::collection::vec(any::<f64>(), 0..9),
        proptest::collection::vec(any::<String>(), 0..5),
        proptest::collection::vec(pair, 0..5),
        any::<Vec<bool>>(),
    );
    (scalars, lists, kind).prop_map(|(scalars, lists, kind)| {
        let (flag, small, short, number, long, single, double) = scalars;
        let (text, bytes, floats, texts, nested, flags) = lists;
        let nothing = Empty;
        Everything {
            flag,
            small,
            short,
            number,
            long,
            single,
            double,
            text,
            bytes,
            floats,
            texts,
            nested,
            kind,
            nothing,
            flags,
        }
    })
}

proptest! {
    #[test]
    fn what_is_encoded_is_decoded(value in everything()) {
        let bytes = encode(&value);
        prop_assert_eq!(decode::<Everything>(&bytes), Ok(value));
    }

    /// Each message that is cut short or made longer is refused.
    #[test]
    fn every_length_but_the_right_one_is_refused(value in everything()) {
        let mut bytes = encode(&value);
        for length in 0..bytes.len() {
            prop_assert!(decode::<Everything>(&bytes[..length]).is_err(), "{}", length);
        }
        bytes.push(0);
        prop_assert!(decode::<Everything>(&bytes).is_err());
    }

    /// Whatever is accepted is a value, and encodes to something that is read as the same value.
    #[test]
    fn any_bytes_are_read_or_refused(value in everything(), place: proptest::sample::Index, byte: u8, noise: Vec<u8>) {
        let _ = decode::<Everything>(&[&HEADER[..], &noise].concat());
        let mut bytes = encode(&value);
        let place = place.index(bytes.len());
        bytes[place] = byte;
        if let Ok(changed) = decode::<Everything>(&bytes) {
            let again = encode(&changed);
            prop_assert_eq!(encode(&decode::<Everything>(&again).unwrap()), again);
        }
    }
}
