use std::ops::{Bound, RangeBounds};

use crate::Field;
use crate::host::cdr::{DecodeError, Reader, Writer};
use crate::host::declaration::ConstText;

/// A source of chance: small, fast, and the same on every machine for the same seed. Not for secrets.
///
/// The generator is xoshiro256++ 1.0 (Blackman and Vigna, "Scrambled linear pseudorandom number generators", 2021), its
/// state filled by SplitMix64, as its authors advise.
///
/// ```
/// use saoms_api::Chance;
///
/// let mut chance = Chance::for_component(7, "hall/Robot001");
/// let block = chance.range(0..=10);
/// assert!((0..=10).contains(&block));
/// assert_eq!(Chance::for_component(7, "hall/Robot001").range(0..=10), block);
/// ```
// Transparent: the boundary to plugins hands out the state.
#[derive(Clone, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Chance {
    state: [u64; 4],
}

/// For state that a component [saves](crate::Component::save): the next one draws on from there.
impl Field for Chance {
    const TYPE: ConstText = <[u64; 4] as Field>::TYPE;
    const LEAST_SIZE: usize = <[u64; 4] as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        self.state.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let at = reader.offset();
        let state = <[u64; 4]>::read(reader)?;
        // From zeros the generator draws zeros for ever.
        if state == [0; 4] {
            Err(DecodeError::new("no source of chance is all zeros", at))
        } else {
            Ok(Chance { state })
        }
    }
}

impl Chance {
    /// The source of this seed.
    pub const fn new(seed: u64) -> Chance {
        let (seed, first) = split_mix(seed);
        let (seed, second) = split_mix(seed);
        let (seed, third) = split_mix(seed);
        let (_, fourth) = split_mix(seed);
        Chance { state: [first, second, third, fourth] }
    }

    /// The source of a component in a run with this seed: independent of those of other names.
    pub fn for_component(seed: u64, name: &str) -> Chance {
        // FNV-1a over the name, then mixed with the seed, so that neighbouring seeds and names share nothing.
        let hash = name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        Chance::new(split_mix(seed).1 ^ split_mix(hash).1.rotate_left(32))
    }

    /// The state, for the boundary to plugins.
    pub(crate) const fn state(&mut self) -> *mut [u64; 4] {
        &raw mut self.state
    }

    /// 64 random bits.
    #[inline]
    pub const fn next_u64(&mut self) -> u64 {
        let [a, b, c, d] = self.state;
        let result = a.wrapping_add(d).rotate_left(23).wrapping_add(a);
        let (c, d) = (c ^ a, d ^ b);
        self.state = [a ^ d, b ^ c, c ^ (b << 17), d.rotate_left(45)];
        result
    }

    /// A number below `n`, each with the same probability; 0 when `n` is 0.
    ///
    /// The method is Lemire's ("Fast random integer generation in an interval", 2019).
    pub fn below(&mut self, n: u64) -> u64 {
        let mut product = u128::from(self.next_u64()) * u128::from(n);
        if (product as u64) < n {
            let least = n.wrapping_neg() % n;
            while (product as u64) < least {
                product = u128::from(self.next_u64()) * u128::from(n);
            }
        }
        (product >> 64) as u64
    }

    /// A number of the range, each with the same probability. An empty range gives its start.
    pub fn range<T: Integer>(&mut self, range: impl RangeBounds<T>) -> T {
        let (least, greatest) = (T::MIN.number(), T::MAX.number());
        let start = match range.start_bound() {
            Bound::Included(start) => start.number(),
            Bound::Excluded(start) => start.number() + 1,
            Bound::Unbounded => least,
        };
        let end = match range.end_bound() {
            Bound::Included(end) => end.number(),
            Bound::Excluded(end) => end.number() - 1,
            Bound::Unbounded => greatest,
        };
        let offset = match u64::try_from(end - start) {
            Ok(u64::MAX) => self.next_u64(),
            Ok(width) => self.below(width + 1),
            Err(_) => 0,
        };
        T::at(start.min(greatest) + i128::from(offset))
    }

    /// A number from 0 to below 1, in steps of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// `true` with this probability: never at 0 or less, always at 1 or more.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Brings the items into a random order (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for place in (1..items.len()).rev() {
            items.swap(place, self.below(place as u64 + 1) as usize);
        }
    }

    /// One of the items, `None` when there is none.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> Option<&'a T> {
        items.get(self.below(items.len() as u64) as usize)
    }
}

/// The next state and number of SplitMix64 (Steele, Lea and Flood, 2014).
const fn split_mix(state: u64) -> (u64, u64) {
    let state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (state, mixed ^ (mixed >> 31))
}

/// The numbers that [`Chance::range`] can give.
pub trait Integer: Copy + private::Sealed {
    /// The least one.
    const MIN: Self;
    /// The greatest one.
    const MAX: Self;
    #[doc(hidden)]
    fn number(self) -> i128;
    #[doc(hidden)]
    fn at(number: i128) -> Self;
}

mod private {
    pub trait Sealed {}
}

macro_rules! integers {
    ($($type:ty),*) => {
        $(
            impl private::Sealed for $type {}
            impl Integer for $type {
                const MIN: Self = <$type>::MIN;
                const MAX: Self = <$type>::MAX;

                fn number(self) -> i128 {
                    self as i128
                }

                fn at(number: i128) -> Self {
                    number as $type
                }
            }
        )*
    };
}

integers!(i8, i16, i32, i64, u8, u16, u32, u64, usize);

#[cfg(test)]
mod tests;
