//! Looking at eight bytes at a time. Names and values are short: this is faster for them than the vectors of `memchr`, and than byte by byte.

const ONES: u64 = 0x0101_0101_0101_0101;
/// The highest bit of each byte.
pub(super) const HIGH: u64 = ONES << 7;

/// Has a bit set when one of the eight bytes is `byte`; the lowest bit set is that of the first of them, those above it may be of others.
#[inline]
pub(super) fn equal(word: u64, byte: u8) -> u64 {
    let difference = word ^ (ONES * u64::from(byte));
    difference.wrapping_sub(ONES) & !difference & HIGH
}

/// Has a bit set when one of the eight bytes is a blank or comes before it, as all white space and controls do.
#[inline]
pub(super) fn up_to_blank(word: u64) -> u64 {
    word.wrapping_sub(ONES * (b' ' as u64 + 1)) & !word & HIGH
}

/// The highest bit of each byte that is beyond a blank.
#[inline]
fn beyond_blank(word: u64) -> u64 {
    // Nothing is carried from one byte to the next: seven bits and this make less than 256.
    let rest = (word & !HIGH) + ONES * (0x7f - b' ' as u64);
    (rest | word) & HIGH
}

/// How many bytes at the start are blanks or come before them.
#[inline]
pub(super) fn blanks(bytes: &[u8]) -> usize {
    let (chunks, rest) = bytes.as_chunks::<8>();
    for (index, chunk) in chunks.iter().enumerate() {
        let found = beyond_blank(u64::from_le_bytes(*chunk));
        if found != 0 {
            return index * 8 + found.trailing_zeros() as usize / 8;
        }
    }
    let found = rest.iter().position(|byte| *byte > b' ').unwrap_or(rest.len());
    bytes.len() - rest.len() + found
}

/// Whether some eight bytes have a bit set by `odd`.
#[inline]
pub(super) fn any(bytes: &[u8], odd: impl Fn(u64) -> u64) -> bool {
    let word = |chunk: &[u8; 8]| u64::from_le_bytes(*chunk);
    if let Some(last) = bytes.last_chunk::<8>() {
        // The last eight hold some a second time unless there are as many as to be eights.
        let (chunks, _) = bytes.as_chunks::<8>();
        return chunks.iter().fold(odd(word(last)), |seen, chunk| seen | odd(word(chunk))) != 0;
    }
    // The first four and the last four hold all of them; fewer are filled up with a letter, which is nothing odd.
    let half = |chunk: &[u8; 4]| u64::from(u32::from_le_bytes(*chunk));
    let all = match (bytes.first_chunk(), bytes.last_chunk()) {
        (Some(first), Some(last)) => half(first) << 32 | half(last),
        _ => bytes.iter().fold(ONES * u64::from(b'a'), |all, byte| all << 8 | u64::from(*byte)),
    };
    odd(all) != 0
}

/// Whether both hold the same bytes.
#[inline]
pub(super) fn same(one: &[u8], other: &[u8]) -> bool {
    let is_same = |(one, other): (&[u8; 8], &[u8; 8])| u64::from_le_bytes(*one) == u64::from_le_bytes(*other);
    if one.len() != other.len() {
        return false;
    }
    match (one.last_chunk(), other.last_chunk()) {
        // The last eight hold some a second time.
        (Some(one_last), Some(other_last)) => {
            let (one, other) = (one.as_chunks().0, other.as_chunks().0);
            is_same((one_last, other_last)) && one.iter().zip(other).all(is_same)
        }
        _ => one.iter().zip(other).all(|(one, other)| one == other),
    }
}

/// How many bytes at the start of both are the same.
#[inline]
pub(super) fn same_start(one: &[u8], other: &[u8]) -> usize {
    let pairs = one.as_chunks::<16>().0.iter().zip(other.as_chunks::<16>().0);
    let mut at = 0;
    for (one, other) in pairs {
        let differs = u128::from_le_bytes(*one) ^ u128::from_le_bytes(*other);
        if differs != 0 {
            return at + differs.trailing_zeros() as usize / 8;
        }
        at += 16;
    }
    let rest = one[at..].iter().zip(&other[at..]);
    at + rest.take_while(|(one, other)| one == other).count()
}

/// Where the first of three bytes is.
#[inline]
pub(super) fn first_of(bytes: &[u8], wanted: [u8; 3]) -> Option<usize> {
    let (chunks, rest) = bytes.as_chunks::<8>();
    for (index, chunk) in chunks.iter().enumerate() {
        let word = u64::from_le_bytes(*chunk);
        let found = wanted.iter().fold(0, |found, byte| found | equal(word, *byte));
        if found != 0 {
            return Some(index * 8 + found.trailing_zeros() as usize / 8);
        }
    }
    let at = rest.iter().position(|byte| wanted.contains(byte))?;
    Some(bytes.len() - rest.len() + at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every byte at every place of texts of up to 20 bytes of another.
    fn texts() -> impl Iterator<Item = Vec<u8>> {
        let bytes = [0, 9, b' ', b'!', b'/', b'<', b'a', 0x7f, 0x80, 0xa0, 0xff];
        let lengths = bytes.into_iter().flat_map(|around| (0..20).map(move |length| vec![around; length]));
        lengths.flat_map(move |text| {
            let odd = (0..text.len()).flat_map(move |at| bytes.map(|byte| (at, byte)));
            let changed = text.clone();
            odd.map(move |(at, byte)| {
                let mut text = changed.clone();
                text[at] = byte;
                text
            })
            .chain([text])
        })
    }

    #[test]
    fn blanks_end_at_the_first_byte_beyond_them() {
        for text in texts() {
            let found = text.iter().position(|byte| *byte > b' ').unwrap_or(text.len());
            assert_eq!(blanks(&text), found, "{text:?}");
        }
    }

    #[test]
    fn bytes_are_found_where_they_are_first() {
        for text in texts() {
            let wanted = [b'<', 0x80, b' '];
            assert_eq!(
                first_of(&text, wanted),
                text.iter().position(|byte| wanted.contains(byte)),
                "{text:?}"
            );
            assert_eq!(any(&text, |word| equal(word, b'/')), text.contains(&b'/'), "{text:?}");
        }
    }

    #[test]
    fn the_same_is_what_has_the_same_bytes() {
        let all: Vec<Vec<u8>> = texts().step_by(7).collect();
        for one in &all {
            for other in all.iter().step_by(5).chain([one]) {
                assert_eq!(same(one, other), one == other, "{one:?} {other:?}");
                let start = one.iter().zip(other).take_while(|(one, other)| one == other).count();
                assert_eq!(same_start(one, other), start, "{one:?} {other:?}");
            }
        }
    }
}
