//! Elements that name intents, policy sets and operations (SCA Policy 1.1, 4.2 and 4.3; SCA 1.0 for operations).

kinds! {
    /// Intents, in an element of their own.
    pub INTENTS = "requires": "Intents of policies. SAOMS does not look at them." {
        known "intents" Names: "The intents that apply.";
    } []

    /// A policy set, in an element of its own.
    pub POLICY_SET = "policySetAttachment": "A set of policies. SAOMS does not look at it." {
        known "name" Names: "The policy set that applies.";
    } []

    /// Policies of an operation.
    pub OPERATION = "operation": "Policies of an operation. SAOMS does not look at them." {
    } []

    /// Elements of other vendors.
    pub EXTENSIONS = "extensions": "Elements of other namespaces, which SAOMS does not look at." {
    } []
}
