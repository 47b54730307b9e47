//! A package of ROS 2 interfaces: the messages of topics, and the operations of services.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use saoms_lang::registry::Registry;
use saoms_lang::ros::{RosType, ros_operation};

/// The name of the package.
const PACKAGE: &str = "saoms_msgs";

/// The files of the package, with their texts.
///
/// # Errors
/// Two types have one name.
pub(super) fn files(registry: &Registry) -> Result<Vec<(PathBuf, String)>, String> {
    let mut types: BTreeMap<String, (String, String)> = BTreeMap::new();
    let mut services: BTreeMap<String, String> = BTreeMap::new();
    for class in registry.iter() {
        let declaration = class.declaration();
        for topic in declaration.publishes.iter().chain(&declaration.subscribes) {
            let form = RosType::of(&topic.schema.to_string()).map_err(|error| error.to_string())?;
            let who = format!("topic `{}` of `{}`", topic.name, declaration.name);
            add(&mut types, form.definitions, &who)?;
        }
        for service in &declaration.services {
            let Some(operations) = service.interface.operations.as_array() else { continue };
            for operation in operations {
                let form = ros_operation(&service.interface.name, operation).map_err(|error| error.to_string())?;
                let who = format!("interface `{}`", service.interface.name);
                add(&mut types, form.definitions, &who)?;
                services.insert(form.name, form.text);
            }
        }
    }
    let own =
        |name: &String| name.split_once('/').filter(|(package, _)| *package == PACKAGE).map(|(_, own)| own.to_owned());
    let mut named: Vec<String> = Vec::new();
    let mut files: Vec<(PathBuf, String)> = Vec::new();
    for (name, (text, _)) in &types {
        if let Some(own) = own(name) {
            named.push(format!("msg/{own}.msg"));
            files.push((PathBuf::from(format!("msg/{own}.msg")), text.clone()));
        }
    }
    for (name, text) in &services {
        named.push(format!("srv/{name}.srv"));
        files.push((PathBuf::from(format!("srv/{name}.srv")), text.clone()));
    }
    let texts = || types.values().map(|(text, _)| text).chain(services.values());
    let others: BTreeSet<&str> = texts().flat_map(|text| packages(text)).filter(|name| *name != PACKAGE).collect();
    let find: String = others.iter().map(|name| format!("find_package({name} REQUIRED)\n")).collect();
    let depend: String = others.iter().map(|name| format!("  <depend>{name}</depend>\n")).collect();
    let needs = if others.is_empty() { String::new() } else { "\n  DEPENDENCIES ".to_owned() + &list(&others) };
    let named: String = named.iter().map(|name| format!("\n  \"{name}\"")).collect();
    files.push((
        PathBuf::from("CMakeLists.txt"),
        format!(
            "cmake_minimum_required(VERSION 3.8)\nproject({PACKAGE})\n\nfind_package(ament_cmake REQUIRED)\n\
             find_package(rosidl_default_generators REQUIRED)\n{find}\n\
             rosidl_generate_interfaces(${{PROJECT_NAME}}{named}{needs}\n)\n\n\
             ament_export_dependencies(rosidl_default_runtime)\nament_package()\n"
        ),
    ));
    files.push((
        PathBuf::from("package.xml"),
        format!(
            "<?xml version=\"1.0\"?>\n<package format=\"3\">\n  <name>{PACKAGE}</name>\n  <version>{}</version>\n  \
             <description>Messages and services of components of SAOMS.</description>\n  \
             <maintainer email=\"nobody@example.com\">nobody</maintainer>\n  <license>MIT</license>\n  \
             <license>Apache-2.0</license>\n\n  <buildtool_depend>ament_cmake</buildtool_depend>\n  \
             <buildtool_depend>rosidl_default_generators</buildtool_depend>\n{depend}  \
             <exec_depend>rosidl_default_runtime</exec_depend>\n  \
             <member_of_group>rosidl_interface_packages</member_of_group>\n\n  <export>\n    \
             <build_type>ament_cmake</build_type>\n  </export>\n</package>\n",
            env!("CARGO_PKG_VERSION")
        ),
    ));
    Ok(files)
}

/// Adds types, which are those of `who`.
fn add(
    types: &mut BTreeMap<String, (String, String)>,
    definitions: Vec<(String, String)>,
    who: &str,
) -> Result<(), String> {
    for (name, text) in definitions {
        match types.get(&name) {
            Some((known, other)) if *known != text => {
                return Err(format!("two types are named `{name}`: that of {other}, and that of {who}"));
            }
            Some(_) => {}
            None => _ = types.insert(name, (text, who.to_owned())),
        }
    }
    Ok(())
}

/// The packages that a definition names.
fn packages(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once('/').map(|(package, _)| package))
}

fn list(names: &BTreeSet<&str>) -> String {
    names.iter().copied().collect::<Vec<_>>().join(" ")
}
