use saoms_api::{Properties, PropertyField};

#[derive(Properties)]
struct OutOfRange {
    #[property(default = 0, range = 1..=99)]
    number: u8,
}

#[derive(Properties)]
struct EmptyRange {
    #[property(range = 5..5)]
    number: u8,
}

#[derive(Properties)]
struct NoLiteral {
    #[property(default = ONE)]
    number: u8,
}

#[derive(Properties)]
struct NotAllowed {
    #[property(allowed("red", "blue"), default = "green")]
    color: String,
}

#[derive(Properties)]
struct SameName {
    charge_x: u8,
    #[property(name = "chargeX")]
    other: u8,
}

#[derive(Properties)]
struct Typo {
    #[property(defualt = 1)]
    number: u8,
}

#[derive(Properties)]
struct WrongType {
    #[property(default = 300)]
    number: u8,
}

#[derive(PropertyField)]
enum Same {
    One,
    #[property(name = "one")]
    Eins,
}

fn main() {}
