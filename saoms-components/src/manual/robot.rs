use saoms_api::{Class, Component, Context, Failure, Properties, info, interface};

use super::{GpsInterfaceReference, Point};

/// Service of the robot for the component that drives it.
#[interface(name = "resources.robotEnvironment.RobotInterface")]
pub trait RobotInterface {
    /// Moves the robot by a distance and returns its new position.
    fn move_by(&mut self, context: &mut Context<'_>, by: Point) -> Result<Point, Failure>;
}

/// Properties of the robot of figure 3.1.
#[derive(Clone, Debug, Properties)]
pub struct ManualRobotProperties {
    /// The robot's name.
    #[property(name = "ID", required_text, unique = "robot")]
    id: String,
    /// Nickname of the robot.
    #[property(default = "")]
    nickname: String,
    /// Weight of the robot.
    #[property(default = 0.0, range = 0.0.., unit = "kg")]
    weight: f64,
    /// Height of the robot.
    #[property(default = 0.0, range = 0.0.., unit = "cm")]
    height: f64,
    /// Price of the robot.
    #[property(default = 0.0, range = 0.0.., unit = "EUR")]
    price: f64,
}

/// The robot of figures 3.1 and 3.2: it moves on request and asks the GPS for its position.
#[derive(Debug, Class)]
#[class(
    name = "resources.robotEnvironment.Robot",
    passive,
    service("move": RobotInterface)
)]
pub struct ManualRobot {
    #[properties]
    properties: ManualRobotProperties,
    #[reference("updatePosition")]
    gps: GpsInterfaceReference,
}

impl Component for ManualRobot {
    type Properties = ManualRobotProperties;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let ManualRobotProperties { id, nickname, weight, height, price } = &self.properties;
        info!(context, "{id} `{nickname}`: {weight} kg, {height} cm, {price} EUR");
        Ok(())
    }
}

impl RobotInterface for ManualRobot {
    fn move_by(&mut self, context: &mut Context<'_>, by: Point) -> Result<Point, Failure> {
        self.gps.carried(context, by)?;
        let position = self.gps.position(context)?;
        info!(context, "moved by {by}, is at {position}");
        Ok(position)
    }
}
