//! Declarations as text, read.

use std::sync::Arc;

use serde::de::DeserializeOwned;

use super::schemas::Schemas;
use super::{
    ClassDeclaration, LoopDeclaration, LoopProvider, Provider, RegisteredClass, RegisteredLoop, RegistryError, error,
    extend, validate,
};

/// The part that every version of a declaration has.
#[derive(serde::Deserialize)]
struct Head {
    contract: u32,
    #[serde(alias = "loop")]
    class: String,
}

/// A class under each of its names, the declared one first.
pub(super) fn class(
    text: &str,
    provider: &Arc<dyn Provider>,
    schemas: &mut Schemas,
) -> Result<Vec<RegisteredClass>, RegistryError> {
    let malformed = |class: String, message| RegistryError::Malformed { class, message };
    let mut own: ClassDeclaration = declaration(text, malformed)?;
    let extended = extend::lineage(text).map_err(|message| malformed(own.name.clone(), message))?;
    let mut base: Option<ClassDeclaration> = None;
    // From the most general one on.
    for text in extended.iter().rev() {
        let mut next: ClassDeclaration = declaration(text, malformed)?;
        inherit(&mut next, base.take())?;
        base = Some(next);
    }
    inherit(&mut own, base)?;
    validate::class(&own).map_err(|message| malformed(own.name.clone(), message))?;
    schemas.share(own.publishes.iter_mut().chain(&mut own.subscribes));
    let extended: Arc<[Arc<str>]> = extended.into_iter().map(Arc::from).collect();
    let declaration = Arc::new(own);
    let text: Arc<str> = text.into();
    let class = |name: &str, presets| RegisteredClass {
        name: name.to_owned(),
        declaration: Arc::clone(&declaration),
        presets,
        text: Arc::clone(&text),
        extended: Arc::clone(&extended),
        provider: Arc::clone(provider),
    };
    let also = declaration.also.iter().map(|alias| {
        // All are known, and each is what its property allows.
        let preset = |(name, text): (&String, &String)| {
            let value = declaration.property(name)?.check(text).ok()?;
            Some((name.into(), value.into()))
        };
        class(&alias.name, alias.preset.iter().filter_map(preset).collect())
    });
    Ok(std::iter::once(class(&declaration.name, Vec::new())).chain(also).collect())
}

fn inherit(class: &mut ClassDeclaration, base: Option<ClassDeclaration>) -> Result<(), RegistryError> {
    let Some(base) = base else { return Ok(()) };
    let inherited = extend::inherit(class, base);
    inherited.map_err(|message| RegistryError::Malformed { class: class.name.clone(), message })
}

pub(super) fn looping(
    text: &str,
    provider: Arc<dyn LoopProvider>,
    schemas: &mut Schemas,
) -> Result<RegisteredLoop, RegistryError> {
    let malformed = |name: String, message| RegistryError::MalformedLoop { name, message };
    let mut declaration: LoopDeclaration = declaration(text, malformed)?;
    validate::looping(&declaration).map_err(|message| malformed(declaration.name.clone(), message))?;
    schemas.share(declaration.publishes.iter_mut().chain(&mut declaration.subscribes));
    Ok(RegisteredLoop { declaration, text: text.into(), provider })
}

fn declaration<D: DeserializeOwned>(
    text: &str,
    malformed: impl Fn(String, String) -> RegistryError,
) -> Result<D, RegistryError> {
    let start: String = text.chars().take(40).collect();
    // First of all the version: another one may have another shape.
    let head: Head = serde_json::from_str(text).map_err(|error| malformed(start, error.to_string()))?;
    if head.contract != error::CONTRACT {
        return Err(RegistryError::Contract { class: head.class, found: head.contract });
    }
    serde_json::from_str(text).map_err(|error| malformed(head.class, error.to_string()))
}
