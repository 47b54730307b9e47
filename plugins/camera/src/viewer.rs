use saoms_api::{Class, Component, Context, Failure, Properties, Subscription};

use crate::picture::{CAMERA, CameraPicture};

/// Properties of a viewer.
#[derive(Debug, Properties)]
pub struct ViewerProperties {
    /// Minimum number of other robots in a picture that the viewer logs.
    #[property(default = 1, range = 0..)]
    others: usize,
}

/// A viewer of the pictures of all cameras, which it counts in the report.
#[derive(Debug, Class)]
#[class(name = "camera.Viewer", periodic, subscribes(CAMERA))]
pub struct Viewer {
    others: usize,
    camera: Subscription<CameraPicture>,
}

impl Component for Viewer {
    type Properties = ViewerProperties;

    fn new(properties: ViewerProperties) -> Result<Self, Failure> {
        Ok(Viewer { others: properties.others, camera: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.camera = context.subscribe(&CAMERA)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for picture in context.receive(&self.camera) {
            context.count("camera.pictures", 1);
            let (robot, block, others) = (picture.robot, picture.block, picture.others());
            if others >= self.others {
                context.info(format_args!("sees {others} other robots from robot {robot} at {block}"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<Viewer>(&[]);
    }
}
