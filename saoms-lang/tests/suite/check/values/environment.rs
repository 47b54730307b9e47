//! Values from the environment.

use std::collections::HashMap;
use std::ffi::OsString;

use expect_test::expect;
use saoms_lang::project::Project;

use crate::check::support::{compiled, part, told};

#[test]
fn values_come_from_the_environment_unless_somebody_gives_one() {
    let text = part(
        "fleet",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="robots" saoms:env="ROBOTS">1</property><property name="speed" saoms:env="SPEED">1</property>
<component name="R${index}" saoms:count="robots"><implementation.java class="example.Robot"/><property name="ID">R${index}</property><property name="period">1</property><property name="number">${index}</property>
<property name="speed" source="$speed"/></component>"#,
    );
    let found = |environment: &[(&str, &str)], settings: &[&str]| {
        let environment: HashMap<String, OsString> =
            environment.iter().map(|(name, value)| ((*name).to_owned(), value.into())).collect();
        let project = Project::new().in_memory().environment(move |name| environment.get(name).cloned());
        let project = project.set_all(settings.iter().copied()).text("fleet", text.as_str());
        let (assembly, diagnostics, sources) = compiled(&project);
        let count = assembly.map(|assembly| assembly.components.len());
        format!("{count:?}\n{}", told(&diagnostics, &sources))
    };
    expect![[r#"
        Some(1)
    "#]]
    .assert_eq(&found(&[], &[]));
    expect![[r#"
        Some(3)
    "#]]
    .assert_eq(&found(&[("ROBOTS", " 3 ")], &[]));
    expect![[r#"
        Some(2)
    "#]]
    .assert_eq(&found(&[("ROBOTS", "3")], &["robots=2"]));
    expect![[r#"
        None
        3:42-48 error S2045: found the text `many`, expected a whole number
          environment:1:8-12 the value of `robots`
          help: `docs/fleets.md` describes expressions
        environment:1:7-8 error S3008: property `speed`: `9` is out of range: expected a number from 0.0 to 2.5 [m/s] (in `R1`, index 1)
          4:32-38 used here as `speed`
          help: `speed`: How fast it drives; the default is `1.0`
    "#]]
    .assert_eq(&found(&[("SPEED", "9"), ("ROBOTS", "many")], &[]));
}
