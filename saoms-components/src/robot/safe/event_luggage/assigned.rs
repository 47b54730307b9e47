//! Luggage that a master assigns to the robot.

use saoms_api::{Cause, Time};

use crate::hardware::ActionKind;
use crate::messages::is_visit;
use crate::robot::{Assigned, Job, RobotKnowledge};

use super::super::energy::Feasibility;
use super::{Hindrance, SafeLuggageDecision, SafeLuggageSymptom};

/// The oldest assignment that this robot has to answer, and its cause.
pub(super) fn look_at_assignment(knowledge: &mut RobotKnowledge) -> Option<(SafeLuggageSymptom, Cause)> {
    let is_late =
        knowledge.job.filter(|job| knowledge.awaits_master > 0 && knowledge.lists.requests.is_delivered(job.luggage));
    if let Some(job) = is_late {
        // Another robot was faster, and has done it.
        return Some((SafeLuggageSymptom::Withdrawn(job), Cause::default()));
    }
    while let Some(Assigned { job, withdrawn, master, cause }) = knowledge.lists.requests.answer_assignment() {
        let is_own = knowledge.job.is_some_and(|own| own.luggage == job.luggage);
        let is_untold = knowledge.untold.is_some_and(|end| end.job.luggage == job.luggage);
        if is_untold || knowledge.lists.requests.has_done(job.luggage) {
            // The master hears how it ended.
            continue;
        }
        if withdrawn {
            let collects = |kind| matches!(kind, ActionKind::Collect | ActionKind::Deposit);
            let collects = knowledge.hardware.running().is_some_and(|action| collects(action.kind));
            if is_own && (knowledge.variables.has_luggage || collects) {
                // It goes on: the master hears how it ends.
                continue;
            }
            return Some((SafeLuggageSymptom::Withdrawn(job), cause));
        }
        if is_own {
            // The master agrees that this robot does it.
            knowledge.awaits_master = 0;
        } else {
            // A late word to a visit that this robot took and left since is no call to do it.
            let is_over = is_visit(job.luggage) && knowledge.lists.requests.has_refused(job.luggage);
            let is_free = !is_over && knowledge.is_free_for(master);
            if is_free {
                knowledge.assigned_by = master;
            }
            return Some((SafeLuggageSymptom::Assigned { job, is_free }, cause));
        }
    }
    None
}

/// Whether the battery lasts for assigned luggage. The master knows who is free, and asks again later.
pub(super) fn decide_about_assigned(job: Job, knowledge: &mut RobotKnowledge) -> SafeLuggageDecision {
    if knowledge.job.is_none() {
        knowledge.keep_usual_reserve();
    }
    match knowledge.means(&job) {
        Feasibility::Enough => SafeLuggageDecision::Take(job),
        Feasibility::Needs(needs) => {
            knowledge.energy.lacks = needs;
            SafeLuggageDecision::HandBack(job)
        }
        Feasibility::Later => SafeLuggageDecision::HandBack(job),
        Feasibility::Never => {
            let why = if knowledge.is_cut_off_from(&job) { Hindrance::NoWay } else { Hindrance::Battery };
            SafeLuggageDecision::Refuse { job, why }
        }
    }
}

impl RobotKnowledge {
    /// True if it can take luggage that this master assigns: it has no job, or one that the same master assigned and
    /// that it can leave. Masters that do not know of each other's jobs would call it back and forth.
    fn is_free_for(&self, master: u32) -> bool {
        let variables = &self.variables;
        let is_from_master = self.is_assigned && self.assigned_by == master;
        let can_leave = self.job.is_some() && is_from_master && !variables.has_luggage && !self.offers_help;
        let is_idle = (self.is_free() && self.job.is_none() || can_leave) && self.untold.is_none();
        let may = !variables.critical && !variables.asleep && !self.must_charge && !self.relieved && !self.stopped;
        is_idle && may && !self.hardware.is_handling()
    }

    /// Makes this its job.
    pub(super) fn take(&mut self, job: Job, now: Time) {
        // Who took an interest before decided by itself; who has a job gets another one.
        let decided = std::mem::replace(&mut self.variables.transporter, true);
        self.is_assigned = !decided || self.job.is_some();
        self.variables.busy = true;
        self.energy.lacks = 0;
        self.job = Some(job);
        self.lease(job.luggage, now);
        self.lists.requests.take(job.luggage);
    }
}
