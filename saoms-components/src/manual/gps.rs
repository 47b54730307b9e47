use std::fmt;

use saoms_api::{Class, Component, Context, Failure, Field, interface};

/// A position, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Field)]
pub struct Point {
    /// To the east of the origin.
    pub x: f64,
    /// To the north of the origin.
    pub y: f64,
}

impl fmt::Display for Point {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "({}, {})", self.x, self.y)
    }
}

/// Service of a GPS receiver for the robot that carries it.
#[interface(name = "resources.robotEnvironment.GPSInterface")]
pub trait GpsInterface {
    /// Moves a simulated receiver together with its carrier.
    fn carried(&mut self, context: &mut Context<'_>, by: Point) -> Result<(), Failure>;

    /// The current position.
    fn position(&mut self, context: &mut Context<'_>) -> Result<Point, Failure>;
}

/// A simulated GPS receiver. It starts at the origin and moves with its carrier.
#[derive(Debug, Default, Class)]
#[class(name = "resources.robotEnvironment.GPS", passive, service("position": GpsInterface))]
pub struct Gps {
    place: Point,
}

impl Component for Gps {
    type Properties = ();
}

impl GpsInterface for Gps {
    fn carried(&mut self, _context: &mut Context<'_>, by: Point) -> Result<(), Failure> {
        self.place.x += by.x;
        self.place.y += by.y;
        Ok(())
    }

    fn position(&mut self, _context: &mut Context<'_>) -> Result<Point, Failure> {
        Ok(self.place)
    }
}
