#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use saoms_transport::Topic;
use serde_json::json;

use crate::key::{End, Keys, attachment, node};
use crate::settings::{Settings, domain};

/// The hash of `std_msgs/msg/String` in all releases of ROS 2 that have hashes.
const HASH: &str = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";

fn chatter() -> Topic {
    let description = "{\"type_description\": {\"type_name\": \"std_msgs/msg/String\", \"fields\": [{\"name\": \"data\", \
        \"type\": {\"type_id\": 17, \"capacity\": 0, \"string_capacity\": 0, \"nested_type_name\": \"\"}}]}, \
        \"referenced_type_descriptions\": []}";
    let topic = json!({"topic": "hall/chatter", "type": "std_msgs/msg/String", "definition": "string data\n",
        "description": description, "schema": {}, "state": false});
    serde_json::from_value(topic).unwrap()
}

#[test]
fn keys_are_those_of_rmw_zenoh() {
    let keys = Keys::of(3, &chatter());
    assert_eq!(keys.messages(), format!("3/hall/chatter/std_msgs::msg::dds_::String_/{HASH}"));
    assert_eq!(
        keys.token("a1", 7, End::Publisher),
        format!("@ros2_lv/3/a1/0/7/MP/%/%/saoms/%hall%chatter/std_msgs::msg::dds_::String_/{HASH}/::,:,:,:,,")
    );
    assert_eq!(node(3, "a1"), "@ros2_lv/3/a1/0/0/NN/%/%/saoms");
    assert_eq!(keys.fault(&keys.messages()), None);
    let other = keys.fault("3/hall/chatter/std_msgs::msg::dds_::String_/RIHS01_00").unwrap();
    assert!(other.starts_with("its sender has another definition of the type: RIHS01_00, expected RIHS01_df66"));
    let beside = attachment(1, 2, [9; 16]);
    assert_eq!((beside.len(), beside[0], beside[8], beside[16], beside[32]), (33, 1, 2, 16, 9));
}

#[test]
fn the_domain_is_a_number_of_ros() {
    assert_eq!((domain(None), domain(Some("")), domain(Some(" 42 "))), (Ok(0), Ok(0), Ok(42)));
    for wrong in ["233", "-1", "hall"] {
        assert!(domain(Some(wrong)).unwrap_err().contains("expected a number from 0 to 232"));
    }
}

#[test]
fn what_a_network_of_ros_does_not_have_is_refused() {
    let settings = |more: serde_json::Value| {
        let mut settings = json!({"url": "ros2://localhost:7447", "listen": true});
        settings.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        Settings::read(&settings.to_string()).unwrap().judge()
    };
    assert!(settings(json!({})).is_empty());
    assert_eq!(
        settings(json!({"user": "ada", "tls": {"ca": "ca.pem"}})).iter().map(|one| one.0).collect::<Vec<_>>(),
        ["user", "ca"]
    );
}
