//! A component that takes an event from outside the fleet.

use saoms_api::{Class, Component, Context, Failure, Field, Message, Own, Subscription, Topic, info};

/// Column and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
#[field(pair)]
pub struct Block {
    /// Column, from 0.
    pub x: i32,
    /// Row, from 0.
    pub y: i32,
}

/// What burns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub enum Fuel {
    /// Water puts it out.
    Wood,
    /// It takes twice as long.
    Oil,
}

/// A fire that breaks out.
#[derive(Clone, Debug, PartialEq, Eq, Message)]
pub struct Fire {
    /// The block where it burns.
    pub at: Block,
    /// The periods that it takes to put it out.
    pub size: u8,
    /// What burns; wood where nothing is said.
    pub fuel: Option<Fuel>,
}

/// Fires, as scenarios and people report them.
pub const FIRE: Topic<Fire> = Topic::event("FIRE");

/// The sprinklers of a hall: they put out one fire after the other.
#[derive(Class)]
#[class(name = "sprinkler.Hall", periodic)]
pub struct Hall {
    /// Fires that can wait; a further one is not noticed.
    #[property(default = 8, range = 1..=100)]
    most: u32,
    /// A fire breaks out in the hall.
    #[takes("fire", FIRE)]
    fires: Subscription<Fire>,
    burning: Vec<(Block, u32)>,
}

impl Component for Hall {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for Fire { at, size, fuel } in context.receive(&self.fires) {
            if self.burning.len() < self.most as usize {
                let periods = u32::from(*size) * if *fuel == Some(Fuel::Oil) { 2 } else { 1 };
                self.burning.push((*at, periods));
                context.count("fires.noticed", 1);
            }
        }
        let Some((Block { x, y }, left)) = self.burning.first_mut() else { return Ok(()) };
        *left = left.saturating_sub(1);
        if *left == 0 {
            info!(context, "the fire at ({x},{y}) is out");
            self.burning.remove(0);
            context.count("fires.out", 1);
        }
        Ok(())
    }
}

saoms_api::plugin! { classes: [Hall] }
