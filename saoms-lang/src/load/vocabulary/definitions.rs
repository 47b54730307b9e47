//! The elements of `definitions.xml`, as the XML schemas of SCA Policy 1.0 or 1.1 allow them.

use super::{Kind, Known};

attributes! {
    NAME = required "name" Name: "Its name, in the target namespace of the file.";
    TYPE = required "type" Names: "The element whose type it is, as `sca:binding.ws`.";
    ALWAYS_PROVIDES = known "alwaysProvides" Names: "The intents that it provides by itself.";
    MAY_PROVIDE = known "mayProvide" Names: "The intents that it can provide.";
}

kinds! {
    /// The root of the file.
    pub(crate) DEFINITIONS = "definitions": "Intents, policy sets, and the types of bindings and implementations." {
        known "targetNamespace" Namespace: "The namespace of the names that it gives.";
    } ["intent", "policySet", "bindingType", "implementationType", "externalAttachment", "binding.",
        "documentation"]

    INTENT = "intent": "A requirement, by its name." {
        NAME;
        known "constrains" Names: "The elements that can require it.";
        known "requires" Names: "The intents that it stands for.";
        known "excludes" Names: "The intents that it cannot be together with.";
        known "mutuallyExclusive" Boolean: "Whether only one of its qualifiers can be asked for.";
        known "intentType" Text: "`interaction` or `implementation`.";
    } ["description", "qualifier"]

    QUALIFIER = "qualifier": "One way to meet an intent, or the policies for it." {
        NAME;
        known "default" Boolean: "Whether it is meant where none is said.";
    } ["description", "intentMap"]

    POLICY_SET = "policySet": "Policies that provide intents." {
        NAME;
        known "provides" Names: "The intents that it provides.";
        known "appliesTo" Text: "The elements that it can be for: an XPath.";
        known "attachTo" Text: "The elements that it is attached to: an XPath.";
    } ["policySetReference", "intentMap", "allow", "permitAll", "denyAll", "runAs", "authorization",
        "securityIdentity"]

    POLICY_SET_REFERENCE = "policySetReference": "A policy set whose policies are taken over." {
        required "name" Names: "Its name, with a prefix of its namespace.";
    } []

    INTENT_MAP = "intentMap": "Policies for each qualifier of an intent." {
        required "provides" Names: "The intent.";
        known "default" Text: "In SCA 1.0 the qualifier that is meant where none is said.";
    } ["qualifier"]

    BINDING_TYPE = "bindingType": "What bindings of a type provide by themselves." {
        TYPE; ALWAYS_PROVIDES; MAY_PROVIDE;
    } ["documentation"]

    IMPLEMENTATION_TYPE = "implementationType": "What implementations of a type provide by themselves." {
        TYPE; ALWAYS_PROVIDES; MAY_PROVIDE;
    } ["documentation"]

    EXTERNAL_ATTACHMENT = "externalAttachment": "Attaches intents and policy sets to parts of composites." {
        known "intents" Names: "The intents that are attached.";
        known "policySets" Names: "The policy sets that are attached.";
        required "attachTo" Text: "The elements that it is attached to: an XPath.";
    } []
}

/// The element of this name inside, where its parts are known.
pub(in crate::load) fn definition(name: &str) -> Option<&'static Kind> {
    let all = [&INTENT, &QUALIFIER, &POLICY_SET, &POLICY_SET_REFERENCE];
    let all = all.into_iter().chain([&INTENT_MAP, &BINDING_TYPE, &IMPLEMENTATION_TYPE, &EXTERNAL_ATTACHMENT]);
    all.into_iter().find(|kind| kind.name == name)
}

/// True if an element stands in `definitions.xml` alone.
pub(in crate::load) fn is_of_definitions(name: &str) -> bool {
    name != QUALIFIER.name && definition(name).is_some()
}
