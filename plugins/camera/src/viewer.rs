use saoms_api::{Class, Component, Context, Failure, Own, Subscription, info};

use crate::picture::{CAMERA, CameraPicture};

/// A viewer of the pictures of all cameras, which it counts in the report.
#[derive(Debug, Class)]
#[class(name = "camera.Viewer", periodic)]
pub struct Viewer {
    /// Minimum number of other robots in a picture that the viewer logs.
    #[property(default = 1, range = 0..)]
    others: usize,
    #[subscribes(CAMERA)]
    camera: Subscription<CameraPicture>,
}

impl Component for Viewer {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for picture in context.receive(&self.camera) {
            context.count("camera.pictures", 1);
            let (robot, block, others) = (picture.robot, picture.block, picture.others());
            if others >= self.others {
                info!(context, "sees {others} other robots from robot {robot} at {block}");
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
