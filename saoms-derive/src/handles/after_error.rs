use proc_macro2::TokenStream;
use quote::quote;
use syn::{DeriveInput, Error};

/// The error, and what `impl Component` or `impl Loop` needs: so that the error is the only one. No body of
/// the generated functions ever runs, since the error beside them ends the compilation.
pub(crate) fn after_error(input: &DeriveInput, error: &Error, is_class: bool) -> TokenStream {
    let (ident, error) = (&input.ident, error.to_compile_error());
    if !input.generics.params.is_empty() {
        return error;
    }
    let (derived, of, knowledge) = match is_class {
        true => (quote!(Derived), quote!(Component), None),
        false => (quote!(DerivedLoop), quote!(Loop), Some(quote!(_: &mut dyn ::saoms_api::Knowledge,))),
    };
    let renew = is_class.then(|| {
        quote! {
            fn renew(
                &mut self,
                _: <Self as ::saoms_api::#of>::Properties,
            ) -> ::core::result::Result<(), ::saoms_api::Failure>
            where
                for<'a> Self: ::saoms_api::#of,
            {
                ::core::unreachable!()
            }
        }
    });
    quote! {
        #error

        impl ::saoms_api::host::Fields for #ident {
            type Own = ();
        }

        impl ::saoms_api::host::#derived for #ident {
            fn made<const ASKED: bool>(
                _: <Self as ::saoms_api::#of>::Properties,
            ) -> ::core::result::Result<Self, ::saoms_api::Failure>
            where
                // As it stands, the bound would be a second error where there is no such `impl`.
                for<'a> Self: ::saoms_api::#of,
            {
                ::core::unreachable!()
            }

            #renew

            fn bind(
                &mut self,
                #knowledge
                _: &mut ::saoms_api::Context<'_>,
            ) -> ::core::result::Result<(), ::saoms_api::Failure> {
                ::core::unreachable!()
            }
        }
    }
}
