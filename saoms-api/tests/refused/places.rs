use saoms_api::Message;

#[derive(Clone, Debug, Message)]
#[message(place = "block")]
struct NoPair {
    block: u32,
}

fn main() {}
