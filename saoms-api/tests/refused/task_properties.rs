use saoms_api::{Class, Component, Failure, Properties};

#[derive(Debug, Properties)]
struct CameraProperties {
    url: String,
}

#[derive(Class)]
#[class(name = "test.Camera", periodic)]
struct Camera;

impl Component for Camera {
    type Properties = CameraProperties;

    fn new(_: CameraProperties) -> Result<Self, Failure> {
        Ok(Camera)
    }
}

fn main() {}
