//! The machine of SAOMS: model, load, check, assemble, bus and schedule.
