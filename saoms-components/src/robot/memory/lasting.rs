//! What the loops of a robot know by themselves, saved with the robot.

/// Declares the fields of a loop that outlive it, as a message of this name, and how they are saved and restored.
macro_rules! lasting {
    ($of:ident as $memory:ident { $($field:ident: $type:ty),+ $(,)? }) => {
        /// What the loop knows beside the robot's knowledge.
        #[derive(Clone, Debug, saoms_api::Message)]
        struct $memory {
            $($field: $type,)+
        }

        impl $of {
            fn saved(&self) -> saoms_api::Saved {
                saoms_api::Saved::of(&$memory { $($field: self.$field.clone(),)+ })
            }

            fn go_on(&mut self, saved: &saoms_api::Saved) -> Result<(), saoms_api::Failure> {
                if let Some($memory { $($field,)+ }) = saved.read()? {
                    $(self.$field = $field;)+
                }
                Ok(())
            }
        }
    };
}

pub(in crate::robot) use lasting;
