use std::fmt;

use saoms_api::{Class, Component, Context, Failure, Field, interface};

/// A place, in metres.
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

/// What a GPS receiver offers to the robot that carries it.
#[interface(name = "resources.robotEnvironment.GPSInterface")]
pub trait GpsInterface {
    /// Says that its carrier moved by so much, which the simulated receiver cannot know otherwise.
    fn carried(&mut self, context: &mut Context<'_>, by: Point) -> Result<(), Failure>;

    /// Where it is.
    fn position(&mut self, context: &mut Context<'_>) -> Result<Point, Failure>;
}

/// A simulated GPS receiver. It starts at the origin and goes where it is carried.
#[derive(Debug, Default, Class)]
#[class(name = "resources.robotEnvironment.GPS", passive, service("position": GpsInterface))]
pub struct Gps {
    place: Point,
}

impl Component for Gps {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Gps::default())
    }
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
