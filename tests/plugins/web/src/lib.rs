//! Services over the web: one that is offered, and one that is called.

use std::collections::BTreeMap;
use std::thread::sleep;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Field, Own, interface};

/// A part in store.
#[derive(Clone, Debug, PartialEq, Field)]
pub struct Part {
    name: String,
    count: u32,
    sizes: Vec<f64>,
    note: Option<String>,
}

/// Keeps parts.
#[interface(name = "web.Stock")]
pub trait Stock {
    /// Puts a part into the store, and gives the number of its pieces there.
    fn put_part(&mut self, context: &mut Context<'_>, part: Part) -> Result<u32, Failure>;

    /// The parts of which there are as many pieces, at least.
    fn parts(&mut self, context: &mut Context<'_>, least: u32) -> Result<Vec<Part>, Failure>;

    /// Empties the store.
    fn clear(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;

    /// Takes so many milliseconds.
    fn rest(&mut self, context: &mut Context<'_>, time: u32) -> Result<(), Failure>;
}

/// Keeps parts in memory.
#[derive(Class)]
#[class(name = "web.Store", passive, apart, service("stock": Stock))]
pub struct Store {
    parts: BTreeMap<String, Part>,
}

impl Component for Store {
    type Properties = ();
}

impl Stock for Store {
    fn put_part(&mut self, _: &mut Context<'_>, part: Part) -> Result<u32, Failure> {
        if part.name.is_empty() {
            return Err("a part has a name".into());
        }
        assert!(part.count < 1_000_000, "nobody counts so far");
        let kept = self.parts.entry(part.name.clone()).or_insert_with(|| Part { count: 0, ..part.clone() });
        kept.count += part.count;
        Ok(kept.count)
    }

    fn parts(&mut self, _: &mut Context<'_>, least: u32) -> Result<Vec<Part>, Failure> {
        Ok(self.parts.values().filter(|part| part.count >= least).cloned().collect())
    }

    fn clear(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.parts.clear();
        Ok(())
    }

    fn rest(&mut self, context: &mut Context<'_>, time: u32) -> Result<(), Failure> {
        context.info("rests");
        sleep(Duration::from_millis(u64::from(time)));
        Ok(())
    }
}

/// Asks a store for its parts in each period, and says what it hears.
#[derive(Class)]
#[class(name = "web.Customer", periodic, apart)]
pub struct Customer {
    /// The least number of pieces.
    #[property(default = 1)]
    least: u32,
    /// The number of questions.
    #[property(default = 1)]
    questions: u32,
    #[reference]
    stock: StockReference,
    asked: u32,
}

impl Component for Customer {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.asked == self.questions {
            return Ok(());
        }
        self.asked += 1;
        match self.stock.parts(context, self.least) {
            Ok(parts) => context.info(format!("heard {parts:?}")),
            Err(error) => context.info(format!("failed: {error}")),
        }
        Ok(())
    }
}

saoms_api::plugin! { classes: [Store, Customer] }
