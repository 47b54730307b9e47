use saoms_api::{Field, Message};

#[derive(Clone, Debug, Message)]
struct Tuple(u8);

#[derive(Clone, Debug, Message)]
#[message(key = "robot")]
struct NoSuchKey {
    number: u8,
}

#[derive(Clone, Debug, Message)]
struct Generic<T> {
    value: T,
}

#[derive(Clone, Debug, Message)]
enum Choice {
    One,
}

#[derive(Field)]
enum Loaded {
    One(u8),
}

#[derive(Field)]
#[field(repr = "usize")]
enum Wide {
    One,
}

#[derive(Clone, Debug, Message)]
#[message(constants(ONE: u8 = 300, TWO: &[u8] = "two"))]
struct Constants {
    value: u8,
}

#[derive(Clone, Debug, Message)]
#[message(constants(ONE: u8 = 1 + 2))]
struct Sums {
    value: u8,
}

#[derive(Clone, Debug, Message)]
#[message(keys = "value")]
struct Unknown {
    value: u8,
}

#[derive(Clone, Debug, Message)]
#[message(place = "blok")]
struct Misspelt {
    block: u8,
}

fn main() {}
