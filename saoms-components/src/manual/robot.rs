use saoms_api::{Class, Component, Context, Failure, Properties, interface};

use super::{GpsInterface, GpsInterfaceReference, Point};

/// What the robot offers to whoever drives it.
#[interface(name = "resources.robotEnvironment.RobotInterface")]
pub trait RobotInterface {
    /// Moves by so much; the answer is where the robot is then.
    fn move_by(&mut self, context: &mut Context<'_>, by: Point) -> Result<Point, Failure>;
}

/// What figure 3.1 says about the robot.
#[derive(Clone, Debug, Properties)]
pub struct RobotProperties {
    /// The robot's name.
    #[property(name = "ID", required_text, unique = "robot")]
    id: String,
    /// What people call it.
    #[property(default = "")]
    nickname: String,
    /// How heavy it is.
    #[property(default = 0.0, range = 0.0.., unit = "kg")]
    weight: f64,
    /// How high it is.
    #[property(default = 0.0, range = 0.0.., unit = "cm")]
    height: f64,
    /// What it costs.
    #[property(default = 0.0, range = 0.0.., unit = "EUR")]
    price: f64,
}

/// The robot of figures 3.1 and 3.2: it moves when it is told to, and asks the GPS where it is.
#[derive(Debug, Class)]
#[class(
    name = "resources.robotEnvironment.Robot",
    passive,
    service("move": RobotInterface),
    reference("updatePosition": GpsInterface)
)]
pub struct Robot {
    properties: RobotProperties,
    gps: GpsInterfaceReference,
}

impl Component for Robot {
    type Properties = RobotProperties;

    fn new(properties: RobotProperties) -> Result<Self, Failure> {
        Ok(Robot { properties, gps: GpsInterfaceReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.gps = context.reference("updatePosition")?;
        let RobotProperties { id, nickname, weight, height, price } = &self.properties;
        context.info(format_args!("{id} `{nickname}`: {weight} kg, {height} cm, {price} EUR"));
        Ok(())
    }
}

impl RobotInterface for Robot {
    fn move_by(&mut self, context: &mut Context<'_>, by: Point) -> Result<Point, Failure> {
        self.gps.carried(context, by)?;
        let position = self.gps.position(context)?;
        context.info(format_args!("moved by {by}, is at {position}"));
        Ok(position)
    }
}
