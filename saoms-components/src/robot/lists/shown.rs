//! Lists of a robot as entries of its knowledge, for loops that read them entry by entry.

use saoms_api::Field;
use saoms_api::host::cdr::{DecodeError, Reader, Writer};
use saoms_api::host::declaration::ConstText;

use crate::messages::{CriticalSituation, Position};
use crate::robot::Job;

use super::{Helps, Peers, Requests, Rival};

/// Luggage that waits for a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Field)]
pub struct WaitingLuggage {
    /// The job.
    pub job: Job,
    /// Other robots that took an interest and did not take it back.
    pub rivals: Vec<Rival>,
}

/// Read as a `Vec` of the messages of the others.
impl Field for Peers {
    const TYPE: ConstText = <Vec<Position> as Field>::TYPE;
    const LEAST_SIZE: usize = <Vec<Position> as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        let all: Vec<Position> = self.all().cloned().collect();
        all.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Err(kept(reader))
    }
}

/// Read as a `Vec` of [`WaitingLuggage`].
impl Field for Requests {
    const TYPE: ConstText = <Vec<WaitingLuggage> as Field>::TYPE;
    const LEAST_SIZE: usize = <Vec<WaitingLuggage> as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        let open = self.open().iter();
        let open: Vec<WaitingLuggage> =
            open.map(|request| WaitingLuggage { job: request.job, rivals: request.rivals.clone() }).collect();
        open.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Err(kept(reader))
    }
}

/// Read as a `Vec` of the requests.
impl Field for Helps {
    const TYPE: ConstText = <Vec<CriticalSituation> as Field>::TYPE;
    const LEAST_SIZE: usize = <Vec<CriticalSituation> as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        let open: Vec<CriticalSituation> = self.open().iter().map(|help| help.situation.clone()).collect();
        open.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Err(kept(reader))
    }
}

/// No loop can set such a list.
fn kept(reader: &Reader<'_>) -> DecodeError {
    DecodeError::new("the robot keeps this list itself, by the messages that it hears", reader.offset())
}
