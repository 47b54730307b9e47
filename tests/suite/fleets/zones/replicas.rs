//! Zones that are the replicas of one component.

use saoms_testkit::Fleet;

use super::{HOUR, assert_delivered};

/// Four zones side by side on 16 columns, each with so many, and robots that bring luggage from one end to the other.
fn fleet(width: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1" name="replicas"
              targetNamespace="urn:replicas">
          <component name="World">
            <implementation.rust class="saoms.World"/>
            <property name="ID">World</property>
            <property name="period">100</property>
            <property name="width">16</property>
            <property name="height">4</property>
          </component>
          <component name="Zone${{index}}" saoms:count="4">
            <implementation.rust class="saoms.Zone"/>
            <property name="ID">Zone${{index}}</property>
            <property name="period">100</property>
            <property name="number">${{index}}</property>
            <property name="x">${{4 * (index - 1)}}</property>
            <property name="width">{width}</property>
            <reference name="world" target="World"/>
          </component>
          <component name="Environment">
            <implementation.rust class="saoms.Environment"/>
            <property name="ID">Environment</property>
            <property name="period">100</property>
            <property name="scenario">from 1s every 2s 12 times luggage (1,0)..(3,3) to (12,0)..(15,3)</property>
          </component>
          <component name="Master">
            <implementation.rust class="saoms.MasterEnvironment"/>
            <property name="ID">Master</property>
            <property name="period">100</property>
          </component>
          <component name="Robot${{index}}" saoms:count="4">
            <implementation.rust class="saoms.Robot"/>
            <property name="ID">Robot${{index}}</property>
            <property name="period">100</property>
            <property name="chargeX">0</property>
            <property name="chargeY">${{index - 1}}</property>
            <property name="discharge">0.2</property>
            <reference name="world" target="World"/>
          </component>
        </composite>"#
    ))
}

#[test]
fn zones_of_replicas_divide_a_map() {
    let run = fleet("4").run(1, HOUR);
    assert_delivered(&run, 12, "four zones");
    let zones = run.components.iter().filter(|one| one.name.starts_with("Zone") && one.messages.sent > 8);
    assert_eq!(zones.count(), 4, "each of them grants something");
}

#[test]
fn replicas_that_overlap_are_refused() {
    let found = fleet("${5 - index / 4}").diagnostics();
    let expected = "two zones grant the block (4,0): `Zone1` has it, too (in `Zone2`, index 2, and in 2 more)";
    assert!(found.contains("error S5023") && found.contains(expected), "{found}");
}
