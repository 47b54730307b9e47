//! Messages that programs of ROS 2 draw: types of `foxglove_msgs`, `nav_msgs`, `tf2_msgs`, and those in them. Their
//! fields, names and order are those of these packages, as others read them by that.

use saoms_api::Message;
use saoms_api::builtin_interfaces::{Duration, Time};

/// A point in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Point")]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

/// A size or a distance in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Vector3")]
pub(super) struct Vector3 {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Quaternion")]
pub(super) struct Quaternion {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
    pub(super) w: f64,
}

impl Default for Quaternion {
    /// No rotation.
    fn default() -> Quaternion {
        Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

/// A place with a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Pose")]
pub(super) struct Pose {
    pub(super) position: Point,
    pub(super) orientation: Quaternion,
}

impl Pose {
    /// A place without a rotation.
    pub(super) const fn at(x: f64, y: f64, z: f64) -> Pose {
        Pose { position: Point { x, y, z }, orientation: Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 } }
    }
}

/// The time and the frame of a message.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "std_msgs/msg/Header")]
pub(super) struct Header {
    pub(super) stamp: Time,
    pub(super) frame_id: String,
}

/// How a frame lies in another one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Transform")]
pub(super) struct Transform {
    pub(super) translation: Vector3,
    pub(super) rotation: Quaternion,
}

/// How a frame lies in that of the header.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/TransformStamped")]
pub(super) struct TransformStamped {
    pub(super) header: Header,
    pub(super) child_frame_id: String,
    pub(super) transform: Transform,
}

/// How frames lie in others.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "tf2_msgs/msg/TFMessage")]
pub(super) struct Transforms {
    pub(super) transforms: Vec<TransformStamped>,
}

/// Size and place of a grid.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "nav_msgs/msg/MapMetaData")]
pub(super) struct MapMetaData {
    pub(super) map_load_time: Time,
    /// Metres of a cell.
    pub(super) resolution: f32,
    pub(super) width: u32,
    pub(super) height: u32,
    /// The corner of the first cell.
    pub(super) origin: Pose,
}

/// A map as a grid: 0 is free, 100 is occupied.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "nav_msgs/msg/OccupancyGrid")]
pub(super) struct OccupancyGrid {
    pub(super) header: Header,
    pub(super) info: MapMetaData,
    /// Row by row, in the order of y.
    pub(super) data: Vec<i8>,
}

/// A colour, each part from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/Color")]
pub(super) struct Color {
    pub(super) r: f64,
    pub(super) g: f64,
    pub(super) b: f64,
    pub(super) a: f64,
}

/// A value with its name.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/KeyValuePair")]
pub(super) struct KeyValuePair {
    pub(super) key: String,
    pub(super) value: String,
}

/// An arrow.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/ArrowPrimitive")]
pub(super) struct Arrow {
    pub(super) pose: Pose,
    pub(super) shaft_length: f64,
    pub(super) shaft_diameter: f64,
    pub(super) head_length: f64,
    pub(super) head_diameter: f64,
    pub(super) color: Color,
}

/// A cuboid around its place.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/CubePrimitive")]
pub(super) struct Cube {
    pub(super) pose: Pose,
    pub(super) size: Vector3,
    pub(super) color: Color,
}

/// A ball.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/SpherePrimitive")]
pub(super) struct Sphere {
    pub(super) pose: Pose,
    pub(super) size: Vector3,
    pub(super) color: Color,
}

/// A cylinder that stands around its place.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/CylinderPrimitive")]
pub(super) struct Cylinder {
    pub(super) pose: Pose,
    pub(super) size: Vector3,
    pub(super) bottom_scale: f64,
    pub(super) top_scale: f64,
    pub(super) color: Color,
}

/// Lines through points.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/LinePrimitive", constants(LINE_STRIP: u8 = 0, LINE_LOOP: u8 = 1, LINE_LIST: u8 = 2))]
pub(super) struct Line {
    pub(super) r#type: u8,
    pub(super) pose: Pose,
    pub(super) thickness: f64,
    pub(super) scale_invariant: bool,
    pub(super) points: Vec<Point>,
    pub(super) color: Color,
    pub(super) colors: Vec<Color>,
    pub(super) indices: Vec<u32>,
}

/// Triangles.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/TriangleListPrimitive")]
pub(super) struct Triangles {
    pub(super) pose: Pose,
    pub(super) points: Vec<Point>,
    pub(super) color: Color,
    pub(super) colors: Vec<Color>,
    pub(super) indices: Vec<u32>,
}

/// A text.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/TextPrimitive")]
pub(super) struct Text {
    pub(super) pose: Pose,
    /// True if it always faces who looks at it.
    pub(super) billboard: bool,
    pub(super) font_size: f64,
    pub(super) scale_invariant: bool,
    pub(super) color: Color,
    pub(super) text: String,
}

/// A model in a file.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/ModelPrimitive")]
pub(super) struct Model {
    pub(super) pose: Pose,
    pub(super) scale: Vector3,
    pub(super) color: Color,
    pub(super) override_color: bool,
    pub(super) url: String,
    pub(super) media_type: String,
    pub(super) data: Vec<u8>,
}

/// The end of an entity.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/SceneEntityDeletion", constants(MATCHING_ID: u8 = 0, ALL: u8 = 1))]
pub(super) struct Deletion {
    pub(super) timestamp: Time,
    pub(super) r#type: u8,
    pub(super) id: String,
}

/// A thing in a scene, which takes the place of the one of the same topic with the same `id`.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/SceneEntity")]
pub(super) struct Entity {
    pub(super) timestamp: Time,
    pub(super) frame_id: String,
    pub(super) id: String,
    /// How long it is there; 0 is until it ends.
    pub(super) lifetime: Duration,
    /// True if it moves with its frame.
    pub(super) frame_locked: bool,
    pub(super) metadata: Vec<KeyValuePair>,
    pub(super) arrows: Vec<Arrow>,
    pub(super) cubes: Vec<Cube>,
    pub(super) spheres: Vec<Sphere>,
    pub(super) cylinders: Vec<Cylinder>,
    pub(super) lines: Vec<Line>,
    pub(super) triangles: Vec<Triangles>,
    pub(super) texts: Vec<Text>,
    pub(super) models: Vec<Model>,
}

/// Things of a scene that end, begin or change.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "foxglove_msgs/msg/SceneUpdate")]
pub(super) struct Scene {
    pub(super) deletions: Vec<Deletion>,
    pub(super) entities: Vec<Entity>,
}
