use saoms_api::{CallError, Class, Component, Context, Failure, Finding, Place, Properties, Work, info};

use super::{Point, RobotInterfaceReference};

/// Properties of a navigator.
#[derive(Clone, Debug, Properties)]
pub struct NavigatorProperties {
    /// Corners of the path in metres, such as `3 0`; by default a square of 2 metres. The path ends at the last corner.
    path: Vec<String>,
    /// Distance that the robot moves in a period.
    #[property(default = 1.0, range = 0.001.., unit = "m")]
    step: f64,
}

/// Leads a robot along a path, one step in each period.
#[derive(Debug, Class)]
#[class(name = "resources.robotEnvironment.Navigator", periodic)]
pub struct Navigator {
    path: Vec<Point>,
    step: f64,
    next: usize,
    /// The last position that the robot reported.
    place: Point,
    #[reference("move")]
    robot: RobotInterfaceReference,
}

impl Component for Navigator {
    type Properties = NavigatorProperties;

    fn new(properties: NavigatorProperties) -> Result<Self, Failure> {
        let path: Vec<Option<Point>> = properties.path.iter().map(|text| corner(text)).collect();
        let wrong = properties.path.iter().zip(&path).enumerate().filter(|(_, (_, corner))| corner.is_none());
        let findings: Vec<Finding> = wrong.map(|(value, (text, _))| wrong_corner(value, text)).collect();
        if !findings.is_empty() {
            return Err(Failure::of_findings(findings));
        }
        let path: Vec<Point> = path.into_iter().flatten().collect();
        let square = [(2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0)].map(|(x, y)| Point { x, y });
        Ok(Navigator {
            path: if path.is_empty() { square.to_vec() } else { path },
            step: properties.step,
            next: 0,
            place: Point::default(),
            robot: RobotInterfaceReference::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.vote(Work::Open);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let Some(corner) = self.path.get(self.next) else { return Ok(()) };
        let (x, y) = (corner.x - self.place.x, corner.y - self.place.y);
        let (distance, step) = (x.hypot(y), self.step);
        let share = if distance > step { step / distance } else { 1.0 };
        match self.robot.move_by(context, Point { x: x * share, y: y * share }) {
            Ok(place) => self.place = place,
            // The call is repeated in the next period, as it is by `?` where the robot is busy.
            Err(CallError::NotRunning { .. }) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
        if distance <= step {
            info!(context, "reached corner {} of {} at {corner}", self.next + 1, self.path.len());
            self.next += 1;
            if self.next == self.path.len() {
                context.vote(Work::Done);
            }
        }
        Ok(())
    }
}

fn corner(text: &str) -> Option<Point> {
    let mut numbers = text.split([' ', ',']).filter(|word| !word.is_empty()).map(str::parse::<f64>);
    match (numbers.next(), numbers.next(), numbers.next()) {
        (Some(Ok(x)), Some(Ok(y)), None) if x.is_finite() && y.is_finite() => Some(Point { x, y }),
        _ => None,
    }
}

fn wrong_corner(value: usize, text: &str) -> Finding {
    let place = Place::property("path").part(value, 0..text.len());
    Finding::new(place, format!("found `{text}`, expected two numbers such as `3 0`"))
}
