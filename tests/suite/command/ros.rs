//! Interfaces of ROS 2: its files as declarations in Rust, and messages and services here as a package of it.

use std::fs;
use std::path::Path;

use saoms_lang::ros::read_ros_file;

use crate::support::{answer, saoms_in, text};

fn write(folder: &Path, name: &str, content: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, content).unwrap();
}

#[test]
fn files_of_ros_become_declarations() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "geometry_msgs/msg/Point.msg", "# A point.\n\nfloat64 x  # along\nfloat64 y 0.5\n");
    let goal =
        "uint8 NONE=0\nstring<=4 type\ngeometry_msgs/Point[36] points\nbuiltin_interfaces/Time stamp\nKind[] kinds\n";
    write(folder.path(), "nav_msgs/msg/Goal.msg", goal);
    write(folder.path(), "nav_msgs/msg/Kind.msg", "");
    write(folder.path(), "example_interfaces/srv/AddTwoInts.srv", "int64 a\nint64 b\n---\nint64 sum\n");
    let files = [
        "geometry_msgs/msg/Point.msg",
        "nav_msgs/msg/Goal.msg",
        "nav_msgs/msg/Kind.msg",
        "example_interfaces/srv/AddTwoInts.srv",
    ];
    let made = saoms_in(folder.path(), &[&["new", "messages", "-o", "src/messages.rs"], &files[..]].concat());
    assert_eq!(answer(&made), (0, "Made src/messages.rs\n".to_owned(), String::new()));
    let declarations = fs::read_to_string(folder.path().join("src/messages.rs")).unwrap();
    for part in [
        "    /// A point.\n    #[derive(Clone, Debug, Default, PartialEq, Message)]\n    \
         #[message(name = \"geometry_msgs/msg/Point\")]\n    pub struct Point {\n        /// along\n        pub x: f64,\n        \
         /// In ROS 2 the default is `0.5`.\n        pub y: f64,\n    }\n",
        "    #[derive(Clone, Debug, PartialEq, Message)]\n    #[message(name = \"nav_msgs/msg/Goal\", constants(\n        \
         NONE: u8 = 0,\n    ))]\n",
        "        pub r#type: Bounded<String, 4>,\n        pub points: [super::geometry_msgs::Point; 36],\n        \
         pub stamp: saoms_api::builtin_interfaces::Time,\n        pub kinds: Vec<Kind>,\n",
        "    pub struct Kind {}\n",
        "    #[interface(name = \"example_interfaces/srv/AddTwoInts\")]\n    pub trait AddTwoInts {\n",
        "request: AddTwoIntsRequest) -> Result<AddTwoIntsResponse, Failure>;",
    ] {
        assert!(declarations.contains(part), "{part}\n{declarations}");
    }
}

#[test]
fn all_faults_of_all_files_are_told_with_their_places() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a_msgs/msg/One.msg", "int3 x\nbool\n");
    write(folder.path(), "a_msgs/msg/Two.msg", "b_msgs/Three three\n\nTwo two\n");
    write(folder.path(), "Loose.msg", "bool on\n");
    let files = ["a_msgs/msg/One.msg", "a_msgs/msg/Two.msg", "Loose.msg"];
    let made = saoms_in(folder.path(), &[&["new", "messages", "-o", "messages.rs"], &files[..]].concat());
    let expected = "error: a_msgs/msg/One.msg:1:1: there is no type `int3`\n\
                    error: a_msgs/msg/One.msg:2:5: there is no name behind the type\n\
                    error: Loose.msg: the file lies in no folder `PACKAGE/msg` or `PACKAGE/srv`: give its `--package`\n\
                    error: a_msgs/msg/Two.msg:1:1: `b_msgs/Three` is in none of the files: give its file, too\n\
                    error: a_msgs/msg/Two.msg:3:1: `a_msgs/Two` contains a message that contains it\n";
    assert_eq!(answer(&made), (2, String::new(), expected.to_owned()));
}

#[test]
fn messages_and_services_become_a_package_of_ros() {
    let folder = tempfile::tempdir().unwrap();
    let written = saoms_in(folder.path(), &["schema", "-o", "saoms_msgs", "--ros2"]);
    assert!(written.status.success(), "{}", text(&written));
    let listed = text(&written);
    let read = |name: &str| fs::read_to_string(folder.path().join("saoms_msgs").join(name)).unwrap();
    for name in listed.lines().filter_map(|line| line.strip_prefix("saoms_msgs/")) {
        if let Some((kind, _)) = name.split_once('/') {
            assert!(read("CMakeLists.txt").contains(&format!("\n  \"{name}\"")), "{name}");
            read_ros_file(&read(name), kind == "srv").unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
        }
    }
    assert_eq!(read("msg/Block.msg"), "int32 x\nint32 y\n");
    assert!(listed.contains("saoms_msgs/msg/Position.msg\n") && listed.contains("saoms_msgs/srv/"), "{listed}");
    assert!(roxmltree::Document::parse(&read("package.xml")).is_ok());
}
