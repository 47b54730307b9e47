//! Fleets that a test puts together.

use std::fmt::Write;

use saoms_testkit::Fleet;

/// The manual's area with its masters, an environment that plays this scenario, and these robots, given as number and
/// further properties: `2 asleep=true battery=60`. Periods are those of the manual.
pub(crate) fn fleet(policy: &str, master: &str, scenario: &str, robots: &[&str]) -> Fleet {
    let mut text =
        String::from(r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="test" targetNamespace="urn:test">"#);
    let mut add = |class: &str, id: &str, period: u32, properties: &str, rest: &str| {
        let _ = write!(
            text,
            r#"<component name="{id}"><implementation.java class="{class}"/>
            <property name="ID">{id}</property><property name="period">{period}</property>"#
        );
        for property in properties.split_whitespace() {
            let (name, value) = property.split_once('=').unwrap();
            let _ = write!(text, r#"<property name="{name}">{value}</property>"#);
        }
        let _ = write!(text, "{rest}</component>");
    };
    add("saoms.World", "World", 500, "width=11 height=11", "");
    add("unibg.saoms.MasterEnvironmentManagingSystem", "MEMS", 500, "", "");
    add("unibg.saoms.MasterRobotManagingSystem", "MRMS", 500, master, "");
    let scenario = format!(r#"<property name="scenario">{scenario}</property>"#);
    add("launch.Environment", "Environment", 500, "", &scenario);
    for robot in robots {
        let (number, properties) = robot.split_once(' ').unwrap_or((*robot, ""));
        let id = format!("Robot{:03}", number.parse::<u32>().unwrap());
        let properties = format!("policy={policy} {properties}");
        add("saoms.Robot", &id, 1000, &properties, r#"<reference name="world" target="World"/>"#);
    }
    Fleet::of_text(text + "</composite>")
}
