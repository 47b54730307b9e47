/* The boundary between SAOMS and a library that was built separately, for authors in C and in languages that call C.
 *
 * Generated from `saoms-abi`; `docs/c.md` is the guide, `plugins/robot-in-c` an example.
 *
 * - Nothing is shared but these tables of functions and the bytes that are lent for the time of a call. Each side frees
 *   what it allocated; text and bytes that a callee gives back go through a sink of the caller.
 * - A library is never unloaded, so texts that are part of it may be kept. Nothing may unwind or jump out of a function.
 * - A component, and all functions that it is lent, are used by one thread at a time, and only until the present call
 *   ends.
 * - All text is UTF-8. Messages, arguments and replies are CDR: see `saoms_author.h`, which helps with them.
 * - A table says its size, in bytes, in its first member. Within one version tables only grow at their end: ask the size
 *   of a table of the program before you use a function that is newer than the oldest program which you support.
 */

#ifndef SAOMS_H
#define SAOMS_H

#include <stddef.h>
#include <stdint.h>

// The section of a library for its metadata, which are read before anything in the library runs:
// `SAOMS_METADATA static const char metadata[] = "{\"saoms\":\"plugin\",...}";`. `docs/c.md` describes them.
#define SAOMS_METADATA __attribute__((used, section(".saoms.plugin")))

// The function that the metadata name as the entry: `SAOMS_EXPORT const SaomsPluginTable *my_entry(uint32_t version)`.
#ifdef __cplusplus
#define SAOMS_EXPORT extern "C" __attribute__((visibility("default")))
#else
#define SAOMS_EXPORT __attribute__((visibility("default")))
#endif

struct SaomsHostHandle;

// The greatest length of a message, a text or a reply; a longer one is refused.
#define SAOMS_MAX_BYTES (64 << 20)

// The version of the boundary. A program loads libraries of its own version alone.
#define SAOMS_ABI_VERSION 3

// The version of the boundary to transports, which changes when a table, a structure or a rule of it changes.
#define SAOMS_TRANSPORT_VERSION 1

// Bytes that are lent for the time of a call.
typedef struct SaomsBytes {
    // The first byte; may be null when there are none.
    const uint8_t *data;
    // Their number.
    size_t length;
} SaomsBytes;

// The outcome of a call. Every value but `OK` comes with a text in the call's sink for errors.
typedef uint32_t SaomsStatus;
// It is done.
#define SaomsStatus_OK 0
// A failure.
#define SaomsStatus_FAILED 1
// The code of the callee panicked.
#define SaomsStatus_PANICKED 2
// The reference is not wired; the text is its name.
#define SaomsStatus_NOT_WIRED 3
// The provider is in the middle of something; the text is its name. A component may answer with it, too: its
// execution is skipped, its initialization and shutdown are tried again.
#define SaomsStatus_BUSY 4
// The provider is not running; the text is its name.
#define SaomsStatus_NOT_RUNNING 5
// The provider knows no such service, operation or arguments.
#define SaomsStatus_MISMATCH 6
// The provider failed; the text is its name, a zero byte, and its words.
#define SaomsStatus_PROVIDER_FAILED 7
// A transport or the program has no room for a message now. No text comes with it.
#define SaomsStatus_FULL 8
// Nobody answers at the url of a network now.
#define SaomsStatus_UNREACHABLE 9

// The value of a property.
typedef struct SaomsPropertyView {
    // The property's name; empty for one of many values.
    struct SaomsBytes name;
    // 0: `text` counts; 1: `children` are its many values; 2: `children` are the properties of a complex one.
    uint32_t kind;
    // The text; of a boolean, a number or a duration the usual one, as `true`, `7`, `0.5` and `1500ms`.
    struct SaomsBytes text;
    // The values that it consists of.
    const struct SaomsPropertyView *children;
    // Their number.
    size_t child_count;
} SaomsPropertyView;

// A place in a composite: a component, a property of it, or a part of the property's text.
typedef struct SaomsPlaceView {
    // The place of the component in its fleet; `SIZE_MAX`: the one that says so.
    size_t component;
    // The property; null: the component itself.
    struct SaomsBytes property;
    // 1: these bytes of this value of the property, which counts from 0; 0: all of it.
    uint32_t has_part;
    // The number of the value.
    size_t value;
    // The first byte.
    size_t start;
    // The first byte behind it.
    size_t end;
} SaomsPlaceView;

// A further place that explains a finding.
typedef struct SaomsLabelView {
    // Its place.
    struct SaomsPlaceView place;
    // The explanation.
    struct SaomsBytes text;
} SaomsLabelView;

// A fault in a composite, found by a class or a rule.
typedef struct SaomsFindingView {
    // Its place.
    struct SaomsPlaceView place;
    // The message: what was found, and what was expected.
    struct SaomsBytes message;
    // Lines of help.
    const struct SaomsBytes *helps;
    // Their number.
    size_t help_count;
    // The text that is probably meant in place of the part; null: none.
    struct SaomsBytes instead;
    // Further places.
    const struct SaomsLabelView *labels;
    // Their number.
    size_t label_count;
    // 0: as the rule's code says, 1: a note, 2: a warning, 3: an error.
    uint32_t severity;
} SaomsFindingView;

// The receiver of findings that a callee gives back. They are copied at once.
typedef struct SaomsFindingSink {
    // The caller's own; the first argument of `put`.
    void *state;
    // Takes a finding.
    void (*put)(void *state, const struct SaomsFindingView *finding);
} SaomsFindingSink;

// The receiver of text or bytes that a callee gives back. They are copied at once; putting again appends.
typedef struct SaomsSink {
    // The caller's own; the first argument of `put`.
    void *state;
    // Appends bytes.
    void (*put)(void *state, struct SaomsBytes bytes);
} SaomsSink;

// The function that makes a component or a loop from the values of the composite, which it may refuse with findings.
// The checker makes components that never run, so it does no work, opens nothing and sends nothing.
typedef SaomsStatus (*SaomsConstruct)(const struct SaomsPropertyView *values,
                                      size_t value_count,
                                      void **made,
                                      struct SaomsFindingSink findings,
                                      struct SaomsSink error);

// A topic that a component publishes or subscribes to.
typedef struct SaomsTopicView {
    // The name before any `topicRename`.
    struct SaomsBytes name;
    // The name of the message type.
    struct SaomsBytes message;
    // The schema of the message type, as JSON.
    struct SaomsBytes schema;
    // 0: state, 1: event.
    uint32_t kind;
} SaomsTopicView;

// A value for the run's report.
typedef struct SaomsReportView {
    // Its name within `children` of kind 6.
    struct SaomsBytes name;
    // 0: null, 1: false or true (`bits`), 2: a whole number (`bits`), 3: a number (`bits` of its IEEE
    // 754 form), 4: the `text`, 5: the list of `children`, 6: the named `children`.
    uint32_t kind;
    // A number.
    uint64_t bits;
    // A text.
    struct SaomsBytes text;
    // The values that it consists of.
    const struct SaomsReportView *children;
    // Their number.
    size_t child_count;
} SaomsReportView;

// The visitor of a component's loops, called with a name, a class, values and their number.
typedef void (*SaomsLoopVisitor)(void *visitor,
                                 struct SaomsBytes name,
                                 struct SaomsBytes class_name,
                                 const struct SaomsPropertyView *values,
                                 size_t value_count);

// The declaration of an entry.
typedef struct SaomsEntryView {
    // Its name; stays as long as the program runs.
    struct SaomsBytes name;
    // Its type as a fragment of a schema; stays as long as the program runs.
    struct SaomsBytes of;
    // 1 if of the loops of a component only one may change it.
    uint32_t effector;
} SaomsEntryView;

// A value of a record or an entry.
typedef struct SaomsValueView {
    // 0: false or true (`bits` 0 or 1), 1: a whole number (`bits` as a signed integer), 2: a number
    // (`bits` of its IEEE 754 form), 3: a pair (the first in the lower 32 bits of `bits`), 4: the `word`, 5: no value,
    // 6: a text in `word`.
    uint32_t kind;
    // The value.
    uint64_t bits;
    // A word, which has to be part of the library; or a text, which is copied within the call.
    struct SaomsBytes word;
} SaomsValueView;

// The functions of entries. The first argument of each is the `state` of their handle. An entry is known by its place.
typedef struct SaomsEntriesFunctions {
    // The size of this table in bytes.
    size_t size;
    // Their declaration, as JSON; empty for entries of a loop.
    struct SaomsBytes (*declaration)(void *state);
    // Their number.
    uint32_t (*count)(void *state);
    // The declaration of one that is there.
    void (*describe)(void *state, uint32_t entry, struct SaomsEntryView *view);
    // Gives the value of one; 0 where it is no single value.
    uint32_t (*get)(void *state, uint32_t entry, struct SaomsValueView *value);
    // Sets it.
    SaomsStatus (*set)(void *state, uint32_t entry, const struct SaomsValueView *value, struct SaomsSink error);
    // Gives the CDR form of one.
    SaomsStatus (*get_bytes)(void *state, uint32_t entry, struct SaomsSink bytes, struct SaomsSink error);
    // Sets it from that.
    SaomsStatus (*set_bytes)(void *state, uint32_t entry, struct SaomsBytes bytes, struct SaomsSink error);
    // Frees entries that were given away; does nothing for those that are lent.
    void (*destroy)(void *state);
} SaomsEntriesFunctions;

// Entries that the other side holds: the knowledge of a component for the time of a call, or the entries that a loop
// adds to it.
typedef struct SaomsEntriesHandle {
    // The first argument of each function.
    void *state;
    // The functions.
    const struct SaomsEntriesFunctions *functions;
} SaomsEntriesHandle;

// A function of a loop, with its component's knowledge.
typedef SaomsStatus (*SaomsStep)(void *looping,
                                 const struct SaomsEntriesHandle *knowledge,
                                 const struct SaomsHostHandle *host,
                                 struct SaomsSink error);

// The functions of a loop. The first argument of each is the loop.
typedef struct SaomsLoopTable {
    // The size of this table in bytes.
    size_t size;
    // The name of an entry that it changes, by its number from 0; empty behind the last. It stays as long as the
    // program runs.
    struct SaomsBytes (*effect)(void *looping, uint32_t number);
    // The entries that it adds to the knowledge; 0 where there are none.
    uint32_t (*entries)(void *looping, struct SaomsEntriesHandle *given);
    // Asks for topics, references and entries. Called once, after all loops have added their entries.
    SaomsStep initialize;
    // Takes in messages and measurements. Called in each execution, for all loops before the first one adapts.
    SaomsStep monitor;
    // Analyzes, plans and executes, and writes symptom and decision to the journal. The caller finds the changes by
    // itself.
    SaomsStep adapt;
    // Ends the work.
    SaomsStep shutdown;
    // Frees the loop.
    void (*destroy)(void *looping);
} SaomsLoopTable;

// A loop that is given away, with its functions.
typedef struct SaomsLoopInstance {
    // The loop.
    void *instance;
    // Its functions.
    const struct SaomsLoopTable *table;
} SaomsLoopInstance;

// A record of the journal. Id, text and names have to be part of the library.
typedef struct SaomsRecordView {
    // What the record is found by, in `snake_case`: it stays when the text is reworded. Empty: the text is the id.
    struct SaomsBytes id;
    // The text, with `{name}` where a value goes, and `{name:one|several}` where a word depends on its being 1.
    struct SaomsBytes text;
    // The names of the values, each with a comma behind it.
    struct SaomsBytes names;
    // The values.
    const struct SaomsValueView *values;
    // The number of the values, at most 6.
    size_t count;
} SaomsRecordView;

// A function that stops the hardware of a component. The host calls it from any of its threads, at any time and any
// number of times, also while another function of the component runs or hangs, and never after `release`.
typedef struct SaomsStopView {
    // The size of this structure in bytes.
    size_t size;
    // The library's own; the first argument of the functions.
    void *state;
    // Stops the hardware, and may wait for it. `FAILED`, with a text in `error`: it may still move.
    SaomsStatus (*stop)(void *state, struct SaomsSink error);
    // Tells the hardware that its component is alive: it stops by itself when it hears nothing for twice the period,
    // which is in nanoseconds. Must not wait. `FAILED`, with a text in `error`: whoever has executed fails. May be
    // null: there is no heartbeat.
    SaomsStatus (*heartbeat)(void *state, uint64_t period, struct SaomsSink error);
    // Frees the state. May be null: there is nothing to free.
    void (*release)(void *state);
} SaomsStopView;

// The visitor of what a component keeps, called with a number and the bytes under it.
typedef void (*SaomsKeptVisitor)(void *visitor, uint64_t key, struct SaomsBytes bytes);

// A region of blocks, from one corner to the other, both included.
typedef struct SaomsRegionView {
    // Column and row of the least corner.
    int32_t least[2];
    // Column and row of the greatest corner.
    int32_t most[2];
} SaomsRegionView;

// The message of a state topic that is not in the region of a subscription any more.
typedef struct SaomsDepartedView {
    // The key of the message; 0 where it has none.
    uint64_t key;
    // The index of its sender.
    uint32_t sender;
} SaomsDepartedView;

// The visitor of the publishers of a topic, called with the index of a component in the running fleet, and with 1 if
// that component was ever scheduled, else 0, and with the number by which it says who speaks in messages, or -1.
typedef void (*SaomsPublisherVisitor)(void *visitor, uint32_t sender, uint32_t has_begun, int64_t number);

// The functions of a component's context. The first argument of each is the `state` of the handle that the present
// call was lent.
//
// Times are nanoseconds of the run, which starts at 0.
typedef struct SaomsHostFunctions {
    // The size of this table in bytes.
    size_t size;
    // The component's name: its path in the composite.
    struct SaomsBytes (*name)(void *state);
    // The component's index in the running fleet, as in the messages that it sends.
    uint32_t (*sender)(void *state);
    // The name of the component with this index; null where there is none.
    struct SaomsBytes (*name_of)(void *state, uint32_t sender);
    // The present time. In virtual time it stands still during an execution.
    uint64_t (*now)(void *state);
    // The present date and time of day, in nanoseconds since 1970-01-01 00:00 of local time; `UINT64_MAX`: there is
    // none, in virtual time.
    uint64_t (*date)(void *state);
    // The time when the present execution was due.
    uint64_t (*due)(void *state);
    // The number of the present execution, from 0.
    uint64_t (*execution)(void *state);
    // The component's period in nanoseconds, 0 for a passive one.
    uint64_t (*period)(void *state);
    // 1 if a long execution should end early: the component was unscheduled, or the run ends.
    uint32_t (*cancelled)(void *state);
    // The state of the component's xoshiro256++, four numbers, which may be advanced in place until the call ends.
    uint64_t *(*chance)(void *state);
    // The next random number of the component's own source: the same seed gives the same ones.
    uint64_t (*next_random)(void *state);
    // Becomes a publisher of a topic that the class declares, in `initialize` alone; gives the index to send with.
    SaomsStatus (*publish)(void *state, const struct SaomsTopicView *topic, uint32_t *publisher, struct SaomsSink error);
    // Becomes a subscriber of a topic that the class declares, in `initialize` alone; gives the place of its inbox.
    SaomsStatus (*subscribe)(void *state,
                             const struct SaomsTopicView *topic,
                             uint32_t *subscription,
                             struct SaomsSink error);
    // Sends a message in its CDR form; it leaves at the end of the present execution. The key is that of the
    // message, as a number, or null.
    SaomsStatus (*send)(void *state,
                        uint32_t publisher,
                        const uint64_t *key,
                        struct SaomsBytes message,
                        struct SaomsSink error);
    // Gives the index of a reference that the class declares, by its name and the name of its interface, in
    // `initialize` alone.
    SaomsStatus (*reference)(void *state,
                             struct SaomsBytes name,
                             struct SaomsBytes interface,
                             uint32_t *reference,
                             struct SaomsSink error);
    // 1 if the reference leads to a component.
    uint32_t (*is_wired)(void *state, uint32_t reference);
    // The number of targets of a reference; the number of one, from 0, goes into the upper 16 bits of the reference's
    // index.
    uint32_t (*targets)(void *state, uint32_t reference);
    // Calls an operation, by its number, through a reference: arguments and reply in their CDR form.
    SaomsStatus (*call)(void *state,
                        uint32_t reference,
                        uint32_t operation,
                        struct SaomsBytes arguments,
                        struct SaomsSink reply,
                        struct SaomsSink error);
    // 1 if somebody reads the log at a level: 0 errors, 1 warnings, 2 information, 3 for debugging, 4 the classic
    // console.
    uint32_t (*listens)(void *state, uint32_t level);
    // Writes a line at such a level.
    void (*log)(void *state, uint32_t level, struct SaomsBytes line);
    // Sets a value of the run's report, such as `map.blocks`; dots lead into nested objects. The last value counts.
    void (*report)(void *state, struct SaomsBytes path, const struct SaomsReportView *value);
    // Adds to a number of the run's report, such as `luggage.delivered`, which several components may share.
    void (*count)(void *state, struct SaomsBytes path, int64_t more);
    // Says that this component has work left (0), or that its work is done (1). The run ends by itself when at least
    // one component voted and the work of all that voted is done. 2 says that some work was given up, so that the run
    // is incomplete, and nothing about what is left; a program that does not know it takes it for 1, until the
    // component says 0 or 1.
    void (*vote)(void *state, uint32_t work);
    // Shows each of the component's loops to `visit`, which gets `visitor` as its first argument.
    void (*chosen_loops)(void *state, void *visitor, SaomsLoopVisitor visit);
    // Makes the loop at this place of `chosen_loops`, of whatever library it is, and gives it away.
    SaomsStatus (*chosen_loop)(void *state, uint32_t place, struct SaomsLoopInstance *given, struct SaomsSink error);
    // Names the loop at this place.
    void (*name_loop)(void *state, uint32_t place, struct SaomsBytes name);
    // Says that the loop at this place acts from now on; `UINT32_MAX`: none.
    void (*enter_loop)(void *state, uint32_t place);
    // Says that records and messages from here on follow from a record of the journal, such as the cause of a message.
    void (*because)(void *state, uint64_t cause);
    // The cause that a message carries which is sent now.
    uint64_t (*cause)(void *state);
    // Writes a record to the journal: of phase 0 a symptom, 1 a decision, 2 an effect.
    void (*journal)(void *state, uint32_t phase, const struct SaomsRecordView *record);
    // Writes to the journal that the present loop changed an entry; its name has to be part of the library.
    void (*changed)(void *state,
                    struct SaomsBytes entry,
                    const struct SaomsValueView *before,
                    const struct SaomsValueView *after);
    // Registers a function that stops the component's hardware from any thread, in `initialize` alone; the declaration
    // of the class says `"stops": true`. The host frees its state with `release`, also when it refuses the function.
    SaomsStatus (*register_stop)(void *state, const struct SaomsStopView *stop, struct SaomsSink error);
    // Keeps these bytes under a number beyond a crash of the component; no bytes remove them. What this and later
    // executions send goes out once they are committed; they are lost if this execution fails.
    SaomsStatus (*keep)(void *state, uint64_t key, struct SaomsBytes bytes, struct SaomsSink error);
    // Passes all that is kept to `visit`, in the order of the numbers; the bytes are lent until the call of the
    // component ends. Not 0 if an earlier program left it, and the component has kept nothing since.
    uint32_t (*kept)(void *state, void *visitor, SaomsKeptVisitor visit);
    // Lets a subscription receive the messages of a region alone; with null it receives all. The schema of the topic
    // has a `place`.
    SaomsStatus (*set_region)(void *state,
                              uint32_t subscription,
                              const struct SaomsRegionView *region,
                              struct SaomsSink error);
    // The message at this place of those that left the region of a subscription since the execution before: 1 if there
    // is one, else 0.
    uint32_t (*departed)(void *state, uint32_t subscription, size_t place, struct SaomsDepartedView *departed);
    // In `initialize` not 0 if the component takes the place of another one and goes on from what that saved:
    // `restore` comes next, and nothing is to be begun or announced anew.
    uint32_t (*goes_on)(void *state);
    // Lets an event happen that components of the same site take, at the end of the present execution: a line such as
    // `fire at=(3,4) size=2 to Hall1`.
    SaomsStatus (*raise)(void *state, struct SaomsBytes event, struct SaomsSink error);
    // Says that a person is needed: a kind such as `assistance`, what it is about, such as a number, or empty, and a
    // line for that person. A null line says that the alert of this kind and subject is over.
    void (*alert)(void *state, struct SaomsBytes kind, struct SaomsBytes subject, struct SaomsBytes line);
    // Shows each other component of the fleet that may publish on a topic, as it is declared, to `visit`, which gets
    // `visitor` as its first argument. The name of the topic is that in the declarations.
    void (*publishers)(void *state, struct SaomsBytes topic, void *visitor, SaomsPublisherVisitor visit);
    // The index in the running fleet of the component that says by a number who speaks in messages of a topic; -1 if
    // there is none. The name of the topic is that in the declarations.
    int64_t (*speaker)(void *state, struct SaomsBytes topic, uint32_t number);
} SaomsHostFunctions;

// A message that arrived.
typedef struct SaomsMessageView {
    // Its CDR form.
    struct SaomsBytes bytes;
    // The time when it was sent, in nanoseconds of the run.
    uint64_t sent;
    // The record of the journal that it follows from; 0 for none.
    uint64_t cause;
    // Its key, if `has_key` is 1.
    uint64_t key;
    // The index of its sender.
    uint32_t sender;
    // 0 or 1.
    uint32_t has_key;
} SaomsMessageView;

// The messages that arrived for a subscription since the last execution.
typedef struct SaomsInbox {
    // The oldest first.
    const struct SaomsMessageView *messages;
    // Their number.
    size_t count;
} SaomsInbox;

// The context that a component is lent for the time of a call: its functions, and the messages that arrived.
typedef struct SaomsHostHandle {
    // The first argument of each function.
    void *state;
    // The functions.
    const struct SaomsHostFunctions *functions;
    // One for each subscription, in the order of subscribing; none at all when nothing arrived.
    const struct SaomsInbox *inboxes;
    // Their number.
    size_t inbox_count;
} SaomsHostHandle;

// The functions of the components of a class. The first argument of each is the component.
//
// They are called from one thread at a time and never twice at once. One that answers something else than `OK` has
// failed, with the text that it put into `error`; the component's `restart` policy decides then.
typedef struct SaomsComponentTable {
    // The size of this table in bytes.
    size_t size;
    // Asks for topics and references. Called once, when the component is scheduled.
    SaomsStatus (*initialize)(void *component, const struct SaomsHostHandle *host, struct SaomsSink error);
    // Does the work of one period, with what arrived since the last one. Never called for a passive component. It must
    // not wait for anything.
    SaomsStatus (*execute)(void *component, const struct SaomsHostHandle *host, struct SaomsSink error);
    // Ends the work; messages that it sends still leave. Called once, when the component is unscheduled or the run
    // ends.
    SaomsStatus (*shutdown)(void *component, const struct SaomsHostHandle *host, struct SaomsSink error);
    // Serves a call of one of the services that the class declares: the number of the operation, arguments and reply
    // in their CDR form.
    SaomsStatus (*serve)(void *component,
                         const struct SaomsHostHandle *host,
                         struct SaomsBytes service,
                         uint32_t operation,
                         struct SaomsBytes arguments,
                         struct SaomsSink reply,
                         struct SaomsSink error);
    // Frees the component.
    void (*destroy)(void *component);
    // Puts the state from which a component of a new build continues, when that takes its place in a running fleet;
    // nothing where it begins anew. `FAILED`: it cannot be replaced now. May be null: there is no state.
    SaomsStatus (*save)(void *component, struct SaomsSink saved, struct SaomsSink error);
    // Continues from the state that a component of an earlier build put, after `initialize`. May be null: it cannot.
    SaomsStatus (*restore)(void *component, struct SaomsBytes saved, struct SaomsSink error);
    // Puts what the component waits for, which completes "it waits for": it does none of the work that is left until
    // a message or a call reaches it. Puts nothing where it may act by itself. Asked when nothing has happened in the
    // fleet for a while. May be null, or beyond the `size` of the table: it may act by itself.
    SaomsStatus (*waits_for)(void *component, struct SaomsSink text, struct SaomsSink error);
    // Handles messages of the topics that the composite names in `trigger`, which come here alone. Supervised like
    // `execute`. Of a class whose declaration says `"reacts": true`; else it may be null.
    SaomsStatus (*react)(void *component, const struct SaomsHostHandle *host, struct SaomsSink error);
    // Takes new values of properties whose declaration says `"live": true`, between two executions: all values are
    // given. `FAILED`: it refuses them, and goes on with those that it has. May be null where there is no such
    // property.
    SaomsStatus (*update)(void *component,
                          const struct SaomsPropertyView *values,
                          size_t value_count,
                          struct SaomsSink error);
    // Puts what an operator wants to know of the component now, as one JSON object of named values:
    // `{"battery": 80.5, "block": [3, 1]}`. Asked while nothing else of the component runs, when somebody looks at the
    // running fleet. It must not wait, and changes nothing. May be null, or beyond the `size` of the table: there is
    // nothing to tell beyond what the program counts itself.
    SaomsStatus (*status)(void *component, struct SaomsSink values, struct SaomsSink error);
} SaomsComponentTable;

// A class: how to make components of it, and their functions.
typedef struct SaomsClassTable {
    // The size of this table in bytes.
    size_t size;
    // Makes a component of it.
    SaomsConstruct construct;
    // The functions of its components.
    const struct SaomsComponentTable *component;
} SaomsClassTable;

// A loop class: how to make loops of it, and their functions.
typedef struct SaomsLoopClassTable {
    // The size of this table in bytes.
    size_t size;
    // Makes a loop of it.
    SaomsConstruct construct;
    // The functions of its loops.
    const struct SaomsLoopTable *looping;
} SaomsLoopClassTable;

// A list of texts.
typedef struct SaomsTextList {
    // The first.
    const struct SaomsBytes *texts;
    // Their number.
    size_t count;
} SaomsTextList;

// A reference of a component that is wired.
typedef struct SaomsWireView {
    // Its name.
    struct SaomsBytes reference;
    // The index of the component that it leads to.
    size_t target;
} SaomsWireView;

// A topic of a component with another name on the bus.
typedef struct SaomsRenamedView {
    // Its name in the declaration.
    struct SaomsBytes declared;
    // Its name on the bus.
    struct SaomsBytes on_bus;
} SaomsRenamedView;

// A component of a fleet.
typedef struct SaomsMemberView {
    // Its path in the composite.
    struct SaomsBytes path;
    // The name of its class, as declared.
    struct SaomsBytes class_name;
    // The declaration of its class.
    struct SaomsBytes declaration;
    // The declarations of the classes that its class extends, the nearest first.
    struct SaomsTextList extends;
    // The values of the class's own properties, presets included; an absent one takes its default.
    const struct SaomsPropertyView *values;
    // Their number.
    size_t value_count;
    // From one execution to the next, in nanoseconds; `UINT64_MAX`: it is not periodic.
    uint64_t period;
    // 1 if its messages go to a broker, where others may be that this fleet does not know; otherwise 0.
    uint32_t has_broker;
    // The topics that it publishes, by their names before any `topicRename`.
    struct SaomsTextList publishes;
    // The classes of its loops, in their order.
    struct SaomsTextList loops;
    // Its references that are wired.
    const struct SaomsWireView *wires;
    // Their number.
    size_t wire_count;
    // The topics that have another name on the bus than in the declaration of its class.
    const struct SaomsRenamedView *renamed;
    // Their number.
    size_t renamed_count;
    // 1 if it starts with the fleet; 0 if it waits until another component schedules it.
    uint32_t starts;
} SaomsMemberView;

// The components of a fleet.
typedef struct SaomsFleetList {
    // The components in document order; the place of one here is its index.
    const struct SaomsMemberView *components;
    // Their number.
    size_t component_count;
    // The components that are left out for a fault of their own: the declarations of the class of each and of those
    // that this extends; none where the class is not known.
    const struct SaomsTextList *missing;
    // Their number.
    size_t missing_count;
} SaomsFleetList;

// A rule over whole fleets: finds faults that no component can see alone.
typedef struct SaomsRuleTable {
    // The size of this table in bytes.
    size_t size;
    // The first argument of `check`.
    const void *state;
    // Puts what it finds in a fleet.
    SaomsStatus (*check)(const void *state,
                         const struct SaomsFleetList *fleet,
                         struct SaomsFindingSink findings,
                         struct SaomsSink error);
} SaomsRuleTable;

// The functions of a library that runs classes in the code of another language, which composites name by module and
// class: `implementation.python`. Its metadata list these languages as `"implementations": ["python"]`.
//
// A request is JSON: `{"kind": "python", "module": "counter", "class": "Counter", "folders": ["/site"]}`. The module
// is looked for in these folders first.
typedef struct SaomsImplementationTable {
    // The size of this table in bytes.
    size_t size;
    // Reads what the code of a class declares, and runs nothing of it. The answer is JSON:
    //
    // ```json
    // {"declaration": {}, "file": "/site/counter.py", "installed": false,
    //  "findings": [{"part": "class", "message": "...", "help": ["..."], "instead": ["..."]}]}
    // ```
    //
    // The `declaration` is null where there are findings; the `part` of a finding is the attribute of the composite,
    // `module` or `class`, for which the texts in `instead` are probably meant. `installed`, where the module was
    // found in none of the folders, but where its language finds modules.
    SaomsStatus (*declare)(struct SaomsBytes request, struct SaomsSink answer, struct SaomsSink error);
    // As `construct` of a class. It runs none of the code that the request names: that begins when the component is
    // initialized.
    SaomsStatus (*construct)(struct SaomsBytes request,
                             const struct SaomsPropertyView *values,
                             size_t value_count,
                             void **made,
                             struct SaomsFindingSink findings,
                             struct SaomsSink error);
    // The functions of all its components.
    const struct SaomsComponentTable *component;
} SaomsImplementationTable;

// The tables of what a library offers, each list in the order of its metadata.
typedef struct SaomsPluginTable {
    // The size of this table in bytes.
    size_t size;
    // The version of the boundary that the library was built with.
    uint32_t version;
    // The metadata, as in its own section of the library.
    struct SaomsBytes metadata;
    // The classes.
    const struct SaomsClassTable *const *classes;
    // Their number.
    size_t class_count;
    // The loops.
    const struct SaomsLoopClassTable *const *loops;
    // Their number.
    size_t loop_count;
    // The rules over whole fleets.
    const struct SaomsRuleTable *const *rules;
    // Their number.
    size_t rule_count;
    // The functions for classes in other languages. Null, or beyond the `size` of the table: there are none.
    const struct SaomsImplementationTable *implementations;
} SaomsPluginTable;

// The function by which a library gives its table: it takes the version of the program's boundary.
typedef const struct SaomsPluginTable *(*SaomsEntry)(uint32_t version);

// The functions of the program that a session calls, from threads of its own. They do not wait for long, and are
// valid until `close` returns.
typedef struct SaomsTransportEvents {
    // The size of this table in bytes.
    size_t size;
    // The program's own; the first argument of each function.
    void *state;
    // Delivers a message of a subscription. `FULL`: the program cannot take it now. A session whose thread reads one
    // connection alone reads no more of that, and delivers the message again after a millisecond, until it is taken or
    // the session is closed: so its senders slow down, and nothing has to be sent again. One whose thread serves other
    // connections, too, drops it, as that of Zenoh: the program asks for it again.
    SaomsStatus (*deliver)(void *state,
                           uint64_t token,
                           struct SaomsBytes key,
                           struct SaomsBytes message,
                           struct SaomsBytes attachment);
    // Tells that the link to the network was lost (0) or is there again (1), with a reason for people.
    void (*link)(void *state, uint32_t is_up, struct SaomsBytes reason);
} SaomsTransportEvents;

// The functions of a transport: a library that carries messages between programs, as well as it can. It may lose,
// repeat and reorder them; the program above makes up for that.
//
// The first argument of each function but `open` is a session. They are called from any thread, several at once, and
// never after `close`. A key is text of parts between `/`, of printable ASCII characters without `*`, `$`, `#` and
// `?`; in the keys of a subscription a part `*` is any one part, and `**` at the end any number of parts.
typedef struct SaomsTransportTable {
    // The size of this table in bytes.
    size_t size;
    // The version of the boundary that the library was built with.
    uint32_t version;
    // The metadata, as in its own section of the library.
    struct SaomsBytes metadata;
    // Joins a network, and with `listen` is the place where others join it. `settings` is a JSON text:
    //
    // | member | meaning |
    // | --- | --- |
    // | `url` | where the network is, as the composite says it |
    // | `listen` | true: this program is the network's router, and listens at the url |
    // | `peer` | the name of this program, where the url is `peers://NAME=host:port,NAME=host:port`: it listens at its address, and reaches the others at theirs, without a router; may be missing |
    // | `user`, `password` | of the user as which the program joins; may be missing |
    // | `users` | of a listener: the users that it accepts, each with `user` and `password`; where it is missing, everybody is accepted |
    // | `access` | of a listener: what each `user` may `put` and `subscribe`, lists of keys; where it is missing, everything |
    // | `tls` | `ca`, `certificate` and `key`: paths of files; each may be missing. A listener with `ca` accepts only programs with a certificate that it vouches for |
    //
    // A transport that cannot do what one of these asks for has to refuse it. Passwords are printed nowhere.
    //
    // Waits for no longer than a second. `UNREACHABLE`: nobody answers at the url now, and the program tries again.
    // `FAILED`: it will not help to try again. Both with a text in `error`. A session that was opened connects again
    // by itself after its link was lost.
    SaomsStatus (*open)(struct SaomsBytes settings,
                        const struct SaomsTransportEvents *events,
                        void **session,
                        struct SaomsSink error);
    // Looks at settings, as those of `open`, without joining a network: before anything starts. Puts a JSON text into
    // `faults`, a list of what cannot be used: objects with `setting` (`url`, `listen`, `user`, `users`, `access`,
    // `ca`, `certificate` or `key`) and `text`, what is wrong and what to do. Nothing, or an empty list: all can.
    SaomsStatus (*judge)(struct SaomsBytes settings, struct SaomsSink faults);
    // Sends a message, with what the program says beside it, to all sessions of the network that subscribe to its
    // key, but not to this one. Must not wait for another program, nor for room: a millisecond is the most that it
    // may take for that, as in the transport over Zenoh. `FULL`: too much waits to be sent; the program keeps the
    // message and tries again. `urgent` is 1 for the few short messages, such as signs of life, that should overtake
    // others.
    SaomsStatus (*put)(void *session,
                       struct SaomsBytes key,
                       struct SaomsBytes message,
                       struct SaomsBytes attachment,
                       uint32_t urgent,
                       struct SaomsSink error);
    // Asks for the messages of all keys that fit, which are delivered with this token. No two subscriptions of a
    // session have the same token.
    SaomsStatus (*subscribe)(void *session, struct SaomsBytes keys, uint64_t token, struct SaomsSink error);
    // Ends the subscription with this token.
    SaomsStatus (*unsubscribe)(void *session, uint64_t token, struct SaomsSink error);
    // Sends what waits, for no longer than a second, leaves the network and frees the session. When it returns, no
    // function of `events` runs or is called again.
    void (*close)(void *session);
} SaomsTransportTable;

// The function by which a transport gives its table: it takes the version of the program's boundary.
typedef const struct SaomsTransportTable *(*SaomsTransportEntry)(uint32_t version);

// The functions of a transport of topics: a library that exchanges messages with programs that do not speak the
// program's own language, such as nodes of ROS 2. It knows topics and the types of their messages, and has the
// metadata of a transport, whose member `carries` is `"topics"`.
//
// The first argument of each function but `open` and `judge` is a session. They are called from any thread, several
// at once, and never after `close`. Messages are CDR, with its header of four bytes. A topic is a JSON text:
//
// | member | meaning |
// | --- | --- |
// | `topic` | its name, of the characters that names of ROS 2 may have, without a `/` in front |
// | `type` | the type of its messages, as `saoms_msgs/msg/Position` |
// | `definition` | the type as a text of ROS 2 (`ros2msg`), with the types in it |
// | `description` | the type description as the JSON text whose SHA-256 is its hash (`RIHS01`) |
// | `schema` | the type as declarations of messages have it, with the names of ROS 2 |
// | `state` | true: its newest messages are wanted by late readers, too |
typedef struct SaomsTopicTransportTable {
    // The size of this table in bytes.
    size_t size;
    // The version of the boundary that the library was built with.
    uint32_t version;
    // The metadata, as in its own section of the library.
    struct SaomsBytes metadata;
    // As [`open`](crate::TransportTable::open) of other transports, with the same settings. `events.deliver` takes the
    // messages of topics, with the token of the subscription; the key is the name of who sent the message, or empty.
    // The attachment is empty, or says why what came is no message of the topic: it is counted and told. A session
    // offers again for what there was no room. `events.link` with 1 and a reason tells what is wrong while the link is
    // there.
    SaomsStatus (*open)(struct SaomsBytes settings,
                        const struct SaomsTransportEvents *events,
                        void **session,
                        struct SaomsSink error);
    // As [`judge`](crate::TransportTable::judge) of other transports.
    SaomsStatus (*judge)(struct SaomsBytes settings, struct SaomsSink faults);
    // Says that the program publishes a topic. No two topics of a session, published or subscribed, have the same
    // token.
    SaomsStatus (*advertise)(void *session, struct SaomsBytes topic, uint64_t token, struct SaomsSink error);
    // Publishes a message of the topic that was advertised with this token. `of` is a number: of a state topic the
    // message takes the place of the one before it with the same number. Called by a thread that does nothing else: it
    // may wait for as long as the network is congested. `FULL`: there is no link, or too much waits to be sent; the
    // program keeps the message and tries again.
    SaomsStatus (*publish)(void *session, uint64_t token, uint64_t of, struct SaomsBytes message, struct SaomsSink error);
    // Asks for the messages of a topic, which are delivered with this token.
    SaomsStatus (*subscribe)(void *session, struct SaomsBytes topic, uint64_t token, struct SaomsSink error);
    // Sends what waits, for no longer than a second, leaves the network and frees the session. When it returns, no
    // function of `events` runs or is called again.
    void (*close)(void *session);
} SaomsTopicTransportTable;

// The function by which a transport of topics gives its table: it takes the version of the program's boundary.
typedef const struct SaomsTopicTransportTable *(*SaomsTopicTransportEntry)(uint32_t version);

#endif  /* SAOMS_H */
