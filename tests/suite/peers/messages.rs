//! Messages of ROS 2, declared field by field.

use saoms_api::builtin_interfaces::{Duration, Time};
use saoms_api::{Bounded, Message};

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "std_msgs/msg/Header")]
pub(super) struct Header {
    pub(super) stamp: Time,
    pub(super) frame_id: String,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Point")]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Quaternion")]
pub(super) struct Quaternion {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
    pub(super) w: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Pose")]
pub(super) struct Pose {
    pub(super) position: Point,
    pub(super) orientation: Quaternion,
}

#[derive(Clone, Debug, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/PoseWithCovariance")]
pub(super) struct PoseWithCovariance {
    pub(super) pose: Pose,
    pub(super) covariance: [f64; 36],
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Vector3")]
pub(super) struct Vector3 {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/Twist")]
pub(super) struct Twist {
    pub(super) linear: Vector3,
    pub(super) angular: Vector3,
}

#[derive(Clone, Debug, PartialEq, Message)]
#[message(name = "geometry_msgs/msg/TwistWithCovariance")]
pub(super) struct TwistWithCovariance {
    pub(super) twist: Twist,
    pub(super) covariance: [f64; 36],
}

#[derive(Clone, Debug, PartialEq, Message)]
#[message(name = "nav_msgs/msg/Odometry")]
pub(super) struct Odometry {
    pub(super) header: Header,
    pub(super) child_frame_id: String,
    pub(super) pose: PoseWithCovariance,
    pub(super) twist: TwistWithCovariance,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "sensor_msgs/msg/LaserScan")]
pub(super) struct LaserScan {
    pub(super) header: Header,
    pub(super) angle_min: f32,
    pub(super) angle_max: f32,
    pub(super) angle_increment: f32,
    pub(super) time_increment: f32,
    pub(super) scan_time: f32,
    pub(super) range_min: f32,
    pub(super) range_max: f32,
    pub(super) ranges: Vec<f32>,
    pub(super) intensities: Vec<f32>,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "sensor_msgs/msg/NavSatStatus", constants(
    STATUS_NO_FIX: i8 = -1,
    STATUS_FIX: i8 = 0,
    STATUS_SBAS_FIX: i8 = 1,
    STATUS_GBAS_FIX: i8 = 2,
    SERVICE_GPS: u16 = 1,
    SERVICE_GLONASS: u16 = 2,
    SERVICE_COMPASS: u16 = 4,
    SERVICE_GALILEO: u16 = 8,
))]
pub(super) struct NavSatStatus {
    pub(super) status: i8,
    pub(super) service: u16,
}

/// What the others have none of; `DEFINITION` is the same in ROS 2.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(name = "test_msgs/msg/Rest", constants(ROBOT: &str = "r\"1\"", HALF: f64 = 0.5, ON: bool = true))]
pub(super) struct Rest {
    pub(super) flag: bool,
    pub(super) few: Bounded<Vec<i32>, 4>,
    pub(super) name: Bounded<String, 8>,
    pub(super) numbers: Vec<f64>,
    pub(super) rgb: [u8; 3],
    pub(super) corners: [Point; 2],
    pub(super) names: [String; 2],
    pub(super) times: Vec<Duration>,
    pub(super) large: i64,
    pub(super) nothing: Vec<u64>,
    pub(super) last: i8,
}

impl Rest {
    /// The definition of the message in the language of ROS 2 interfaces.
    pub(super) const DEFINITION: &str = "\
        bool flag\nint32[<=4] few\nstring<=8 name\nfloat64[] numbers\nuint8[3] rgb\ngeometry_msgs/Point[2] corners\n\
        string[2] names\nbuiltin_interfaces/Duration[] times\nint64 large\nuint64[] nothing\nint8 last\n\
        string ROBOT='r\"1\"'\nfloat64 HALF=0.5\nbool ON=true\n";
}
