use saoms_api::{Context, Failure, interface};

#[interface(name = "test.Borrows")]
trait Borrows {
    fn say(&mut self, context: &mut Context<'_>, text: &str) -> Result<(), Failure>;
}

#[interface(name = "test.Shared")]
trait Shared {
    fn say(&self, context: &mut Context<'_>) -> Result<(), Failure>;
}

#[interface(name = "test.NoContext")]
trait NoContext {
    fn say(&mut self, text: String) -> Result<(), Failure>;
}

#[interface(name = "test.NoResult")]
trait NoResult {
    fn say(&mut self, context: &mut Context<'_>) -> String;
}

#[interface]
trait NoName {}

#[interface(name = "test.Constant")]
trait Constant {
    const ANSWER: u8;
}

fn main() {}
