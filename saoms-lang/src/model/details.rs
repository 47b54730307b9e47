//! Fields that few elements have, in a box of their own.

/// Makes the struct of such fields, and the methods of the element that give them: `optional` ones by reference,
/// `copied` ones by value, a `list` as a slice, and `hidden` ones by no method.
macro_rules! details {
    ($(#[$meta:meta])* $Details:ident of $Owner:ident {
        $($(#[$doc:meta])* $how:ident $field:ident: $Type:ty,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $Details {
            $($(#[$doc])* pub $field: $crate::model::details::details!(@type $how $Type),)*
        }

        impl $Owner {
            $($crate::model::details::details!(@get $how $(#[$doc])* $field: $Type);)*
        }
    };
    (@type list $Type:ty) => { Vec<$Type> };
    (@type $how:ident $Type:ty) => { Option<$Type> };
    (@get hidden $(#[$doc:meta])* $field:ident: $Type:ty) => {};
    (@get optional $(#[$doc:meta])* $field:ident: $Type:ty) => {
        $(#[$doc])*
        pub fn $field(&self) -> Option<&$Type> {
            self.details.as_ref()?.$field.as_ref()
        }
    };
    (@get copied $(#[$doc:meta])* $field:ident: $Type:ty) => {
        $(#[$doc])*
        pub fn $field(&self) -> Option<$Type> {
            self.details.as_ref()?.$field
        }
    };
    (@get list $(#[$doc:meta])* $field:ident: $Type:ty) => {
        $(#[$doc])*
        pub fn $field(&self) -> &[$Type] {
            self.details.as_ref().map_or(&[], |details| &details.$field)
        }
    };
}

pub(super) use details;
