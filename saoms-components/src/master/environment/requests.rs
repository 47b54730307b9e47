//! What the master takes on, and asks robots for.

use saoms_api::{Context, Failure, Header};

use super::MasterEnvironment;
use crate::master::assignment::{AssignmentPolicy, MasterEnvironmentKnowledge};
use crate::master::part::Early;
use crate::messages::{EventLuggage, Visit, is_visit};
use crate::validation::Problem;

/// Greatest number of requests that are published in one execution; others follow in the next ones, so that no queue of
/// a reader that has eight times the period overflows.
pub(super) const MAX_REQUESTS: usize = 128;

impl MasterEnvironment {
    /// Takes on luggage that is for this master.
    pub(super) fn admit(
        &mut self,
        context: &mut Context<'_>,
        header: Header,
        request: &EventLuggage,
    ) -> Result<(), Failure> {
        let EventLuggage { luggage, from, to, .. } = *request;
        match self.knowledge.is_for_this(from) {
            Some(true) => {}
            Some(false) => {
                self.knowledge.filter.note(luggage);
                return Ok(());
            }
            None => {
                self.knowledge.keep_early(header, Early::Luggage(request.clone()));
                return Ok(());
            }
        }
        if self.knowledge.open.job(luggage).is_some_and(|known| known.job.to == to) {
            // Nobody has said yet what becomes of it, or a robot has left it elsewhere.
            return Ok(());
        }
        match self.knowledge.filter.luggage(request) {
            Ok(()) => {
                self.knowledge.open.add(luggage, from, to, context.now());
                context.count("luggage.requested", 1);
                self.request(EventLuggage::request(luggage, from, to), context)
            }
            Err(refusal) => {
                context.count("luggage.ignored", 1);
                if !refusal.is_lost {
                    // What is published again may be done: it is no other piece.
                    context.count("scenario.known", 1);
                }
                self.knowledge.validator.log_rejection(context, header, request, refusal.problem);
                match refusal.is_lost {
                    true => context.send(&self.luggage, EventLuggage::given_up(luggage, from, to)),
                    false => Ok(()),
                }
            }
        }
    }

    /// Asks the robots for a visit, if it is possible and new.
    pub(super) fn ask_to_visit(
        &mut self,
        context: &mut Context<'_>,
        header: Header,
        visit: &Visit,
    ) -> Result<(), Failure> {
        if header.sender == context.sender() {
            return Ok(());
        }
        match self.knowledge.is_for_this(visit.ends()[0]) {
            Some(true) => {}
            Some(false) => {
                self.knowledge.filter.note(visit.visit);
                return Ok(());
            }
            None => {
                self.knowledge.keep_early(header, Early::Visit(visit.clone()));
                return Ok(());
            }
        }
        let MasterEnvironmentKnowledge { validator, filter, open, .. } = &mut self.knowledge;
        if open.job(visit.visit).is_some_and(|known| [known.job.from, known.job.to] == visit.ends()) {
            return Ok(());
        }
        let known = filter.knows(visit.visit).then_some(Problem::KnownLuggage);
        let judged = validator.judge(visit, header, filter.area(), context);
        if let Some(problem) = known.or(judged.err()) {
            context.count("errands.ignored", 1);
            validator.log_rejection(context, header, visit, problem);
            let [first, last] = visit.ends();
            return match known {
                Some(_) => Ok(()),
                None => context.send(&self.luggage, EventLuggage::given_up(visit.visit, first, last)),
            };
        }
        filter.note(visit.visit);
        open.add_visit(visit, context.now());
        self.request(visit.request(), context)
    }

    /// Publishes a request, where robots decide by themselves who takes it, or one of them has to.
    pub(super) fn request(&mut self, request: EventLuggage, context: &mut Context<'_>) -> Result<(), Failure> {
        let is_theirs =
            self.knowledge.policy == AssignmentPolicy::Robots || is_visit(request.luggage) && request.robot != 0;
        if !is_theirs {
            return Ok(());
        }
        if self.requested >= MAX_REQUESTS {
            self.requests.push_back((context.cause(), request));
            return Ok(());
        }
        self.requested += 1;
        context.send(&self.luggage, request)
    }
}
