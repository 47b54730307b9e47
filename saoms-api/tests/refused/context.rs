use saoms_api::{Class, Component, Context, Failure, Own};

/// A context serves the call for which it was lent, on its thread.
#[derive(Class)]
#[class(name = "test.Spawner", periodic)]
struct Spawner;

impl Component for Spawner {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        std::thread::spawn(move || context.console("from elsewhere"));
        Ok(())
    }
}

fn main() {}
