/* A component and a loop in C that misbehave: tables with holes by `-D`, the rest by the properties `at` and `does`. */
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "saoms_author.h"

#define JSON(...) #__VA_ARGS__
/* The same with macros in it expanded. */
#define TEXT(...) JSON(__VA_ARGS__)
#define WORD JSON({"name": "Word", "fields": [{"name": "text", "type": "string"}]})

#ifdef STOPS
#define SAYS_STOPS STOPS
#else
#define SAYS_STOPS false
#endif

#ifdef REACTS
#define SAYS_REACTS REACTS
#else
#define SAYS_REACTS false
#endif

#ifdef UNBOUND
/* Nobody has it. */
extern void turn_the_wheels(void);
#endif

typedef struct Actor {
    char at[32], does[32];
    uint32_t publisher, executions;
} Actor;


static volatile int zero = 0;
static volatile int *volatile nowhere = NULL;

static int overflow(volatile int depth) {
    volatile char block[4096];
    memset((char *)block, depth, sizeof block);
    if (depth < zero) {
        return 0;
    }
    return overflow(depth + 1) + block[depth % 4096];
}

static void *end(void *nothing) {
    (void)nothing;
    exit(0);
}

static void act(const Actor *actor, const char *place) {
    if (strcmp(actor->at, place) != 0) {
        return;
    }
    if (strcmp(actor->does, "segv") == 0) {
        *nowhere = 1;
    } else if (strcmp(actor->does, "bus") == 0) {
        raise(SIGBUS);
    } else if (strcmp(actor->does, "ill") == 0) {
        __builtin_trap();
    } else if (strcmp(actor->does, "fpe") == 0) {
        raise(SIGFPE);
    } else if (strcmp(actor->does, "abort") == 0) {
        abort();
    } else if (strcmp(actor->does, "overflow") == 0) {
        zero = overflow(1);
    } else if (strcmp(actor->does, "print") == 0) {
        printf("printed by a library\n");
        fflush(stdout);
    } else if (strcmp(actor->does, "exit") == 0) {
        exit(0);
    } else if (strcmp(actor->does, "exit on a thread") == 0) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, end, NULL) == 0) {
            pthread_join(thread, NULL);
        }
    } else if (strcmp(actor->does, "hang") == 0) {
        for (;;) {
            sleep(1);
        }
    }
}

static SaomsStatus construct(const SaomsPropertyView *values, size_t count, void **made, SaomsFindingSink findings,
                             SaomsSink error) {
    Actor *actor = calloc(1, sizeof *actor);
    (void)error;
    saoms_property_text(values, count, "at", actor->at, sizeof actor->at);
    saoms_property_text(values, count, "does", actor->does, sizeof actor->does);
    if (strcmp(actor->does, "null finding") == 0) {
        findings.put(findings.state, NULL);
        return SaomsStatus_FAILED;
    }
    act(actor, "construct");
    *made = actor;
    return SaomsStatus_OK;
}

/* The functions of a motor whose state is a text. */
static SaomsStatus stop_motor(void *state, SaomsSink error) {
    if (strcmp(state, "dead line") == 0) {
        error.put(error.state, saoms_text("the line is dead"));
        return SaomsStatus_FAILED;
    }
    fprintf(stderr, "the motor is stopped\n");
    return SaomsStatus_OK;
}

static SaomsStatus beat_motor(void *state, uint64_t period, SaomsSink error) {
    if (strcmp(state, "dead heart") == 0) {
        return saoms_fail(error, "the heart is dead");
    }
    fprintf(stderr, "the motor hears: %llu\n", (unsigned long long)period);
    return SaomsStatus_OK;
}

static void release_motor(void *state) {
    fprintf(stderr, "the motor is released\n");
    free(state);
}

static SaomsStatus register_motor(const Actor *actor, const SaomsHostHandle *host, SaomsSink error) {
    char *state = strcpy(malloc(sizeof actor->does), actor->does);
    SaomsStopView view = {sizeof view, state, stop_motor, beat_motor, release_motor};
    if (strcmp(actor->does, "null stop") == 0) {
        view.stop = NULL;
    }
    if (strcmp(actor->does, "null motor") == 0) {
        free(state);
        return host->functions->register_stop(host->state, NULL, error);
    }
    return host->functions->register_stop(host->state, &view, error);
}

static SaomsStatus initialize(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Actor *actor = component;
    SaomsTopicView topic = {saoms_text("WORDS"), saoms_text("Word"), saoms_text(WORD), 1};
    act(actor, "initialize");
#ifdef REACTS
    uint32_t subscription;
    SaomsStatus subscribed = host->functions->subscribe(host->state, &topic, &subscription, error);
    if (subscribed != SaomsStatus_OK) {
        return subscribed;
    }
#endif
#ifdef STOPS
    SaomsStatus registered = register_motor(actor, host, error);
    if (registered != SaomsStatus_OK) {
        return registered;
    }
#else
    (void)register_motor;
#endif
    if (strcmp(actor->does, "null topic") == 0) {
        return host->functions->publish(host->state, NULL, &actor->publisher, error);
    }
    if (strcmp(actor->does, "null index") == 0) {
        return host->functions->subscribe(host->state, &topic, NULL, error);
    }
    if (strcmp(actor->does, "null reference") == 0) {
        return host->functions->reference(host->state, saoms_text("callee"), saoms_text("c.Callee"), NULL, error);
    }
    return host->functions->publish(host->state, &topic, &actor->publisher, error);
}

static SaomsStatus execute(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Actor *actor = component;
    uint8_t memory[64];
    SaomsBuffer message = saoms_writer(memory, sizeof memory);
    act(actor, "execute");
    if (strcmp(actor->does, "record, then abort") == 0) {
        SaomsRecordView record = {.text = saoms_text("it is hot")};
        if (actor->executions++ == 0) {
            host->functions->journal(host->state, 0, &record);
        } else if (actor->executions > 5) {
            abort();
        }
    }
    if (strcmp(actor->does, "speak") == 0) {
        saoms_log(host, SAOMS_INFO, "speaks");
    }
    if (strcmp(actor->does, "alert") == 0) {
        SaomsBytes over = {NULL, 0}, none = {NULL, 1};
        host->functions->alert(host->state, saoms_text("jam"), saoms_text("left"), saoms_text("the left belt jams"));
        host->functions->alert(host->state, saoms_text("jam"), saoms_text("right"), saoms_text("the right belt jams"));
        host->functions->alert(host->state, saoms_text("jam"), saoms_text("right"), over);
        host->functions->alert(host->state, none, saoms_text(""), saoms_text("of no kind"));
    }
    if (strcmp(actor->does, "null views") == 0) {
        SaomsRecordView record = {saoms_text("id"), saoms_text("text"), saoms_text("a,"), NULL, 1};
        host->functions->report(host->state, saoms_text("c.null"), NULL);
        host->functions->journal(host->state, 0, NULL);
        host->functions->journal(host->state, 0, &record);
        host->functions->changed(host->state, saoms_text("entry"), NULL, NULL);
    }
    if (strcmp(actor->does, "records") == 0) {
        SaomsValueView pieces = {.kind = 1, .bits = 1};
        SaomsRecordView record = {saoms_text("piece_waits"), saoms_text("{n} {n:piece waits|pieces wait}"),
                                  saoms_text("n,"), &pieces, 1};
        host->functions->journal(host->state, 0, &record);
        record.id.data = NULL, record.id.length = 0;
        host->functions->journal(host->state, 0, &record);
    }
#ifdef UNBOUND
    if (strcmp(actor->does, "turn") == 0) {
        turn_the_wheels();
    }
#endif
    saoms_write_string(&message, "word");
    return host->functions->send(host->state, actor->publisher, NULL, saoms_written(&message), error);
}

static SaomsStatus react(void *component, const SaomsHostHandle *host, SaomsSink error) {
    (void)error;
    char line[64];
    snprintf(line, sizeof line, "reacts to %zu at %llu", host->inboxes[0].count,
             (unsigned long long)host->functions->now(host->state));
    saoms_log(host, SAOMS_INFO, line);
    act(component, "react");
    return SaomsStatus_OK;
}

static SaomsStatus shutdown(void *component, const SaomsHostHandle *host, SaomsSink error) {
    (void)host, (void)error;
    act(component, "shutdown");
    return SaomsStatus_OK;
}

/* What it says of itself: as it should, or as `does` names it. */
static SaomsStatus status(void *component, SaomsSink values, SaomsSink error) {
    static const char *const said[][2] = {
        {"names twice", "{\"level\": 1, \"level\": 2}"},
        {"names twice inside", "{\"motors\": [{\"left\": 1, \"left\": 2}]}"},
        {"half an object", "{\"level\": "},
        {"two objects", "{} {}"},
        {"a list", "[1, 2]"},
        {"bytes", "{\"level\": \"\xff\"}"},
        {"nothing", ""},
    };
    const Actor *actor = component;
    size_t at;
    act(actor, "status");
    if (strcmp(actor->at, "status") == 0) {
        for (at = 0; at < sizeof said / sizeof said[0]; at++) {
            if (strcmp(actor->does, said[at][0]) == 0) {
                values.put(values.state, saoms_text(said[at][1]));
                return SaomsStatus_OK;
            }
        }
        if (strcmp(actor->does, "fail") == 0) {
            return saoms_fail(error, "nobody knows");
        }
        if (strcmp(actor->does, "odd") == 0) {
            return (SaomsStatus)77;
        }
    }
    values.put(values.state, saoms_text("{\"level\": 80.5, \"most\": 18446744073709551615, \"at\": [3, -1], \"on\": null}"));
    return SaomsStatus_OK;
}

static SaomsStatus serve(void *component, const SaomsHostHandle *host, SaomsBytes service, uint32_t operation,
                         SaomsBytes arguments, SaomsSink reply, SaomsSink error) {
    (void)component, (void)host, (void)service, (void)operation, (void)arguments, (void)reply, (void)error;
    return SaomsStatus_MISMATCH;
}

static void destroy(void *component) {
    act(component, "destroy");
    free(component);
}

static SaomsBytes effect_for_ever(void *looping, uint32_t number) {
    (void)looping, (void)number;
    return saoms_text("brightness");
}

static SaomsBytes effect(void *looping, uint32_t number) {
    (void)looping;
    return number == 0 ? saoms_text("brightness") : saoms_text("");
}

#ifdef NULL_ENTRIES
static uint32_t entries(void *looping, SaomsEntriesHandle *given) {
    static SaomsEntriesFunctions functions = {.size = sizeof functions};
    given->state = looping;
    given->functions = NULL_ENTRIES ? &functions : NULL;
    return 1;
}
#else
static uint32_t entries(void *looping, SaomsEntriesHandle *given) {
    (void)looping, (void)given;
    return 0;
}
#endif

static SaomsStatus step(void *looping, const SaomsEntriesHandle *knowledge, const SaomsHostHandle *host,
                        SaomsSink error) {
    Actor *actor = looping;
    if (strcmp(actor->does, "null value") == 0) {
        return knowledge->functions->set(knowledge->state, 0, NULL, error);
    }
    if (strcmp(actor->does, "null place") == 0) {
        knowledge->functions->describe(knowledge->state, 0, NULL);
        return knowledge->functions->get(knowledge->state, 0, NULL) == 0 ? saoms_fail(error, "nothing was got")
                                                                          : SaomsStatus_OK;
    }
    if (strcmp(actor->does, "null loop") == 0) {
        return host->functions->chosen_loop(host->state, 0, NULL, error);
    }
    return SaomsStatus_OK;
}

#define TOPICS JSON([{"topic": "WORDS", "kind": "event", "message": "Word", "optional": true, "schema":) WORD JSON(}])
#define PROPERTIES JSON("properties": [{"name": "at", "type": "string", "default": ""}, {"name": "does", "type": "string", "default": ""}])

SAOMS_METADATA static const char metadata[] =
    JSON({"saoms": "plugin", "abi":) TEXT(SAOMS_ABI_VERSION) JSON(, "package": "actor", "version": "0.1.0", "entry": "actor_plugin", "classes": [
        {"contract": 1, "class": "c.Actor", "kind": "periodic", "stops":) TEXT(SAYS_STOPS) JSON(, "reacts":) TEXT(SAYS_REACTS) JSON(,) PROPERTIES JSON(,
         "references": [{"name": "callee", "optional": true, "interface": {"name": "c.Callee", "operations": []}}],
         "publishes":) TOPICS JSON(, "subscribes":) TOPICS JSON(}], "loops": [
        {"contract": 1, "loop": "c.Step", "effects": ["brightness"],) PROPERTIES JSON(}]});

#ifndef COMPONENT
#define COMPONENT &component_table
#endif
#ifndef LOOPING
#define LOOPING &loop_table
#endif
#ifndef REACT
#define REACT react
#endif
#ifndef HOLES
#define HOLES
#endif
#ifndef LOOP_HOLES
#define LOOP_HOLES
#endif
#ifndef CONSTRUCT
#define CONSTRUCT construct
#endif
#ifndef SIZE
#define SIZE sizeof(SaomsComponentTable)
#endif

/* A later member of the same name counts. */
static SaomsComponentTable component_table = {
    .size = SIZE, .initialize = initialize, .execute = execute,
    .shutdown = shutdown, .serve = serve, .destroy = destroy, .react = REACT, HOLES
};

static SaomsClassTable class_table = {.size = sizeof class_table, .construct = CONSTRUCT, .component = COMPONENT};

static SaomsLoopTable loop_table = {
    .size = sizeof loop_table, .effect = effect, .entries = entries, .initialize = step,
    .monitor = step, .adapt = step, .shutdown = step, .destroy = destroy, LOOP_HOLES
};

static SaomsLoopClassTable loop_class = {.size = sizeof loop_class, .construct = construct, .looping = LOOPING};

#ifndef CLASS
#define CLASS &class_table
#endif
#ifndef CLASSES
#define CLASSES classes
#endif

SAOMS_EXPORT const SaomsPluginTable *actor_plugin(uint32_t version) {
    static const SaomsClassTable *classes[1];
    static const SaomsLoopClassTable *loops[] = {&loop_class};
    static SaomsPluginTable table = {.size = sizeof table, .version = SAOMS_ABI_VERSION, .class_count = 1, .loop_count = 1};
    (void)version;
    /* Used in all cases, so that a compiler says nothing. */
    (void)component_table, (void)loop_table, (void)effect_for_ever, (void)status;
    classes[0] = CLASS;
    table.classes = CLASSES;
    table.loops = loops;
    table.metadata = saoms_text(metadata);
    return &table;
}
