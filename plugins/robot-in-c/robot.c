/* A robot in C: it patrols along the edge of a rectangle, in one fleet with the robots that ship, with or without zones.
 *
 * It brings no luggage, and says so. Its wheels are those of the world behind its reference `world`; without one it moves at once.
 */

#include "patrol.h"

/* Enough for each message here. */
#define MESSAGE 128

/* In a site with zones it repeats its state after so many executions. */
#define REPEAT_STATE 50

/* The hardware. */

/* Calls the world. 1 and the reply: it answered; 0: it could not be reached now; -1: it failed. */
static int call(Patrol *patrol, const SaomsHostHandle *host, uint32_t operation, SaomsBuffer *arguments,
                SaomsBuffer *reply, SaomsSink error) {
    char words[256];
    SaomsBuffer why = saoms_buffer(words, sizeof words);
    SaomsStatus status = host->functions->call(host->state, patrol->world, operation, saoms_written(arguments),
                                               saoms_sink(reply), saoms_sink(&why));
    if (status == SaomsStatus_BUSY || status == SaomsStatus_NOT_RUNNING) {
        return 0;
    }
    if (status != SaomsStatus_OK) {
        error.put(error.state, saoms_bytes(&why));
        return -1;
    }
    return 1;
}

static SaomsBuffer arguments_of(const Patrol *patrol, uint8_t *memory) {
    SaomsBuffer arguments = saoms_writer(memory, MESSAGE);
    saoms_write_u32(&arguments, patrol->number);
    return arguments;
}

/* It is on the floor. */
static SaomsStatus stand(Patrol *patrol, const SaomsHostHandle *host) {
    patrol->has_entered = 1;
    if (patrol->passage.held_count == 0) {
        begin_passage(patrol, host, 0);
    }
    return SaomsStatus_OK;
}

/* In a site with zones, asks for the block where it starts, unless it stands on the floor already. 1: it may enter. */
static int ask_to_enter(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    Passage *passage = &patrol->passage;
    if (!passage->has_zones) {
        return 1;
    }
    if (passage->held_count == 0) {
        int is_on_floor = 0;
        if (patrol->has_world) {
            uint8_t memory[MESSAGE], answer[MESSAGE];
            SaomsBuffer arguments = arguments_of(patrol, memory), reply = saoms_buffer(answer, sizeof answer);
            int called = call(patrol, host, IS_ON_FLOOR, &arguments, &reply, error);
            SaomsReader reader = saoms_reader(saoms_bytes(&reply));
            if (called < 1) {
                return called;
            }
            is_on_floor = saoms_read_bool(&reader);
        }
        if (is_on_floor) {
            return 1;
        }
        begin_passage(patrol, host, 1);
    }
    if (passage->enters && hear_zones(patrol, host, error) != SaomsStatus_OK) {
        return -1;
    }
    if (passage->enters) {
        return ask_zones(patrol, host, ENTERS, error) == SaomsStatus_OK ? 0 : -1;
    }
    return 1;
}

/* Says to the world that the robot is there. */
static SaomsStatus enter(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    uint8_t memory[MESSAGE], answer[MESSAGE];
    SaomsBuffer arguments = arguments_of(patrol, memory), reply = saoms_buffer(answer, sizeof answer);
    SaomsReader reader;
    int called = ask_to_enter(patrol, host, error);
    if (called < 1) {
        return called == 0 ? SaomsStatus_OK : SaomsStatus_FAILED;
    }
    if (!patrol->has_world) {
        return stand(patrol, host);
    }
    saoms_write_string(&arguments, patrol->name);
    write_block(&arguments, patrol->own.block);
    called = call(patrol, host, ENTER, &arguments, &reply, error);
    if (called < 1) {
        return called == 0 ? SaomsStatus_OK : SaomsStatus_FAILED;
    }
    reader = saoms_reader(saoms_bytes(&reply));
    patrol->own.block = patrol->own.next = patrol->own.wanted = read_block(&reader);
    /* A robot that starts again is where it was left; off its way it stays there. */
    return reader.failed ? saoms_fail(error, "the world does not say where the robot is") : stand(patrol, host);
}

/* Takes in how the move goes that was begun. */
static SaomsStatus take_in(Patrol *patrol, const SaomsHostHandle *host, int progress) {
    patrol->is_moving = progress == RUNNING;
    if (progress == DONE) {
        patrol->own.block = patrol->own.next;
        patrol->moves++;
        host->functions->count(host->state, saoms_text("patrol.moves"), 1);
        if (same(patrol->own.block, patrol->first)) {
            host->functions->count(host->state, saoms_text("patrol.rounds"), 1);
            saoms_log(host, SAOMS_INFO, "is at (%d,%d) again, after %llu moves", (int)patrol->first.x,
                      (int)patrol->first.y, (unsigned long long)patrol->moves);
        }
    } else if (progress == FAILED) {
        patrol->own.next = patrol->own.wanted = patrol->own.block;
        saoms_log(host, SAOMS_WARNING, "could not move");
    }
    return SaomsStatus_OK;
}

/* Begins to move to the block that it wants, or asks how the move goes. */
static SaomsStatus drive(Patrol *patrol, const SaomsHostHandle *host, uint32_t operation, SaomsSink error) {
    uint8_t memory[MESSAGE], answer[MESSAGE];
    SaomsBuffer arguments = arguments_of(patrol, memory), reply = saoms_buffer(answer, sizeof answer);
    SaomsReader reader;
    int called = 1, progress = DONE;
    if (operation == BEGIN) {
        saoms_write_u8(&arguments, 0);
        write_block(&arguments, patrol->own.wanted);
        saoms_write_u32(&arguments, 0);
    }
    if (patrol->has_world) {
        called = call(patrol, host, operation, &arguments, &reply, error);
        reader = saoms_reader(saoms_bytes(&reply));
        progress = saoms_read_u8(&reader);
    }
    if (called < 1) {
        return called == 0 ? SaomsStatus_OK : SaomsStatus_FAILED;
    }
    if (operation == BEGIN) {
        patrol->own.next = patrol->own.wanted;
        patrol->waited = 0;
    }
    return take_in(patrol, host, progress);
}

/* What it says. */

static SaomsStatus send(const SaomsHostHandle *host, uint32_t publisher, uint64_t key, SaomsBuffer *message,
                        SaomsSink error) {
    return host->functions->send(host->state, publisher, &key, saoms_written(message), error);
}

/* Says where it is and what it wants, where the others do not know that yet. */
static SaomsStatus say_position(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    uint8_t memory[MESSAGE];
    SaomsBuffer message = saoms_writer(memory, sizeof memory);
    const Position *own = &patrol->own, *said = &patrol->said;
    if (same(own->block, said->block) && same(own->next, said->next) && same(own->wanted, said->wanted) &&
        own->rank == said->rank && own->right_of == said->right_of && own->robot == said->robot) {
        return SaomsStatus_OK;
    }
    patrol->said = *own;
    write_position(&message, own);
    return send(host, patrol->positions, patrol->number, &message, error);
}

/* Says that it is there, as a robot that takes no jobs: asleep, and with too little charge to be woken. */
static SaomsStatus say_robot(Patrol *patrol, const SaomsHostHandle *host, int active, SaomsSink error) {
    uint8_t memory[MESSAGE];
    SaomsBuffer message = saoms_writer(memory, sizeof memory);
    saoms_write_u32(&message, patrol->number);
    saoms_write_bool(&message, active);
    saoms_write_f64(&message, 35.0);
    saoms_write_bool(&message, 0);
    saoms_write_bool(&message, 1);
    write_block(&message, patrol->first);
    saoms_write_u64(&message, host->functions->period(host->state) / 1000);
    write_block(&message, patrol->own.block);
    saoms_write_u8(&message, 0);
    /* It does not say when it began. */
    saoms_write_u32(&message, 0);
    return send(host, patrol->robots, patrol->number, &message, error);
}

/* Refuses all luggage, so that the master knows when no robot is left for it. */
static SaomsStatus refuse_luggage(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    const SaomsInbox *inbox;
    size_t at;
    if (patrol->luggage_heard >= host->inbox_count) {
        return SaomsStatus_OK;
    }
    inbox = &host->inboxes[patrol->luggage_heard];
    for (at = 0; at < inbox->count; at++) {
        uint8_t memory[MESSAGE];
        SaomsBuffer message = saoms_writer(memory, sizeof memory);
        SaomsReader reader = saoms_reader(inbox->messages[at].bytes);
        uint32_t robot = saoms_read_u32(&reader), luggage = saoms_read_u32(&reader);
        uint8_t stage = saoms_read_u8(&reader);
        Block from = read_block(&reader), to = read_block(&reader);
        SaomsStatus status;
        if (reader.failed || robot != 0 || stage != REQUEST) {
            continue;
        }
        saoms_write_u32(&message, patrol->number);
        saoms_write_u32(&message, luggage);
        saoms_write_u8(&message, REFUSED);
        write_block(&message, from);
        write_block(&message, to);
        write_block(&message, patrol->own.block);
        status = host->functions->send(host->state, patrol->luggage, NULL, saoms_written(&message), error);
        if (status != SaomsStatus_OK) {
            return status;
        }
    }
    return SaomsStatus_OK;
}

/* The functions of the component. */

static SaomsStatus patrol_initialize(void *component, const SaomsHostHandle *host, SaomsSink error);
static SaomsStatus patrol_execute(void *component, const SaomsHostHandle *host, SaomsSink error);
static SaomsStatus patrol_shutdown(void *component, const SaomsHostHandle *host, SaomsSink error);

static SaomsStatus patrol_construct(const SaomsPropertyView *values, size_t count, void **made,
                                    SaomsFindingSink findings, SaomsSink error) {
    Patrol *patrol;
    Block first, last;
    first.x = (int32_t)saoms_property_number(values, count, "left", 0);
    first.y = (int32_t)saoms_property_number(values, count, "top", 0);
    last.x = (int32_t)saoms_property_number(values, count, "right", 10);
    last.y = (int32_t)saoms_property_number(values, count, "bottom", 10);
    if (last.x <= first.x) {
        return saoms_refuse(findings, error, "right", "the rectangle has to be 2 blocks wide at least: right of `left`");
    }
    if (last.y <= first.y) {
        return saoms_refuse(findings, error, "bottom", "the rectangle has to be 2 blocks high at least: below `top`");
    }
    patrol = calloc(1, sizeof *patrol);
    if (patrol == NULL) {
        return saoms_fail(error, "there is no memory left");
    }
    saoms_property_text(values, count, "ID", patrol->name, sizeof patrol->name);
    patrol->number = (uint32_t)saoms_property_number(values, count, "number", 0);
    patrol->first = first;
    patrol->last = last;
    patrol->direction = 1;
    patrol->own.robot = patrol->own.right_of = patrol->number;
    patrol->own.block = patrol->own.next = patrol->own.wanted = first;
    *made = patrol;
    return SaomsStatus_OK;
}

static SaomsStatus patrol_serve(void *component, const SaomsHostHandle *host, SaomsBytes service, uint32_t operation,
                                SaomsBytes arguments, SaomsSink reply, SaomsSink error) {
    (void)component, (void)host, (void)service, (void)operation, (void)arguments, (void)reply;
    error.put(error.state, saoms_text("the patrol has no services"));
    return SaomsStatus_MISMATCH;
}

static void patrol_destroy(void *component) { free(component); }

/* Members by their names: what a later header has more stays null. */
static const SaomsComponentTable component_table = {
    .size = sizeof(SaomsComponentTable),
    .initialize = patrol_initialize,
    .execute = patrol_execute,
    .shutdown = patrol_shutdown,
    .serve = patrol_serve,
    .destroy = patrol_destroy,
};

static SaomsTopicView topic(const char *name, const char *message, const char *schema, uint32_t kind) {
    SaomsTopicView view;
    view.name = saoms_text(name);
    view.message = saoms_text(message);
    view.schema = saoms_text(schema);
    view.kind = kind;
    return view;
}

/* Somebody in its site grants blocks: a component that does so without a number is no zone. */
static void note_zone(void *has_zones, uint32_t sender, uint32_t has_begun, int64_t number) {
    (void)sender, (void)has_begun;
    *(int *)has_zones |= number >= 0;
}

static SaomsStatus patrol_initialize(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Patrol *patrol = component;
    const SaomsHostFunctions *functions = host->functions;
    SaomsTopicView positions = topic("POSTOPIC", "Position", POSITION, 0);
    SaomsTopicView robots = topic("RLMSTOPIC", "RobotList", ROBOT_LIST, 0);
    SaomsTopicView luggage = topic("ELMSTOPIC", "EventLuggage", EVENT_LUGGAGE, 1);
    SaomsTopicView requests = topic("GRANTREQUESTTOPIC", "GrantRequest", GRANT_REQUEST, 0);
    SaomsTopicView territories = topic("ZONETOPIC", "Territory", TERRITORY, 0);
    SaomsTopicView grants = topic("GRANTTOPIC", "Grant", GRANT, 0);
    /* Grants are sent to the number of their robot, as a column, in row 0. */
    SaomsRegionView address = {{(int32_t)patrol->number, 0}, {(int32_t)patrol->number, 0}};
    Passage *passage = &patrol->passage;
    SaomsStatus status;
    if ((status = functions->publish(host->state, &positions, &patrol->positions, error)) != SaomsStatus_OK ||
        (status = functions->publish(host->state, &robots, &patrol->robots, error)) != SaomsStatus_OK ||
        (status = functions->publish(host->state, &luggage, &patrol->luggage, error)) != SaomsStatus_OK ||
        (status = functions->subscribe(host->state, &positions, &patrol->positions_heard, error)) != SaomsStatus_OK ||
        (status = functions->subscribe(host->state, &luggage, &patrol->luggage_heard, error)) != SaomsStatus_OK ||
        (status = functions->publish(host->state, &requests, &passage->requests, error)) != SaomsStatus_OK ||
        (status = functions->subscribe(host->state, &territories, &passage->territories_heard, error)) !=
            SaomsStatus_OK ||
        (status = functions->subscribe(host->state, &grants, &passage->grants_heard, error)) != SaomsStatus_OK ||
        (status = functions->set_region(host->state, passage->grants_heard, &address, error)) != SaomsStatus_OK ||
        (status = functions->reference(host->state, saoms_text("world"), saoms_text("saoms.Hardware"), &patrol->world,
                                       error)) != SaomsStatus_OK) {
        return status;
    }
    patrol->has_world = (int)functions->is_wired(host->state, patrol->world);
    functions->publishers(host->state, grants.name, &passage->has_zones, note_zone);
    if ((status = enter(patrol, host, error)) != SaomsStatus_OK ||
        (status = say_robot(patrol, host, 1, error)) != SaomsStatus_OK) {
        return status;
    }
    if (patrol->passage.enters) {
        return SaomsStatus_OK;
    }
    /* Before anybody moves, everybody has to know which blocks are held. */
    return say_position(patrol, host, error);
}

/* The rest of an execution in a site with zones: it enters what is granted, and nothing else. */
static SaomsStatus follow_grants(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    const Block *next;
    SaomsStatus status;
    release_left(patrol);
    next = granted(patrol);
    if (!patrol->is_moving && next != NULL) {
        patrol->own.wanted = *next;
        if ((status = drive(patrol, host, BEGIN, error)) != SaomsStatus_OK) {
            return status;
        }
        release_left(patrol);
    }
    if ((status = ask_zones(patrol, host, MAKES_WAY, error)) != SaomsStatus_OK) {
        return status;
    }
    next = granted(patrol);
    patrol->own.wanted = next == NULL ? patrol->own.next : *next;
    if (++patrol->passage.executions % REPEAT_STATE == 0) {
        /* Where updates get lost, the others may know an older state. */
        patrol->said.robot = 0;
        if ((status = say_robot(patrol, host, 1, error)) != SaomsStatus_OK) {
            return status;
        }
    }
    return say_position(patrol, host, error);
}

static SaomsStatus patrol_execute(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Patrol *patrol = component;
    SaomsStatus status;
    if ((status = hear_positions(patrol, host, error)) != SaomsStatus_OK ||
        (status = refuse_luggage(patrol, host, error)) != SaomsStatus_OK) {
        return status;
    }
    if (!patrol->has_entered) {
        status = enter(patrol, host, error);
    } else if (patrol->is_moving) {
        status = drive(patrol, host, POLL, error);
    }
    if (status != SaomsStatus_OK || !patrol->has_entered) {
        return status;
    }
    if ((status = hear_zones(patrol, host, error)) != SaomsStatus_OK) {
        return status;
    }
    if (patrol->passage.has_zones) {
        return follow_grants(patrol, host, error);
    }
    if (patrol->is_moving) {
        return SaomsStatus_OK;
    }
    /* It said in an earlier execution that it wants the block. */
    if (may_enter(patrol)) {
        if ((status = drive(patrol, host, BEGIN, error)) != SaomsStatus_OK) {
            return status;
        }
    }
    want(patrol, host);
    return say_position(patrol, host, error);
}

static SaomsStatus patrol_shutdown(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Patrol *patrol = component;
    uint8_t memory[MESSAGE], answer[MESSAGE];
    SaomsBuffer arguments = arguments_of(patrol, memory), reply = saoms_buffer(answer, sizeof answer);
    SaomsStatus status;
    int called = 0;
    if (patrol->has_world && patrol->has_entered) {
        called = call(patrol, host, RETIRE, &arguments, &reply, error);
    }
    if (called < 0) {
        return SaomsStatus_FAILED;
    }
    if (called == 1) {
        SaomsReader reader = saoms_reader(saoms_bytes(&reply));
        Block block = read_block(&reader);
        if (!reader.failed) {
            patrol->own.block = block;
            patrol->is_moving = 0;
        }
    }
    if (patrol->passage.enters) {
        /* It holds nothing, and takes nothing that is on its way. */
        take_no_more(patrol);
        return ask_zones(patrol, host, MAKES_WAY, error);
    }
    if (patrol->passage.has_zones && patrol->passage.held_count > 0) {
        release_left(patrol);
        release_ahead(patrol);
        take_no_more(patrol);
        if ((status = ask_zones(patrol, host, LOST, error)) != SaomsStatus_OK) {
            return status;
        }
    }
    /* It stays where it is, and nobody else gets past it. */
    patrol->own.next = patrol->own.wanted = patrol->own.block;
    patrol->own.rank = IMMOVABLE;
    patrol->own.right_of = 0;
    if ((status = say_position(patrol, host, error)) != SaomsStatus_OK) {
        return status;
    }
    return say_robot(patrol, host, 0, error);
}

/* What the library offers. */

#define TOPIC(name, kind, message) "{\"topic\":\"" name "\",\"kind\":\"" kind "\",\"message\":\"" message "\",\"schema\":"

/* In these messages the field `robot` says who speaks: nobody outside the fleet sends them in the robot's name. */
#define ROBOT_SPEAKS ", \"speakers\": [{\"field\": \"robot\"}]},"

/* It works without anybody who speaks with it there: its site may have no zones. */
#define IF_ANY ", \"optional\": true"

SAOMS_METADATA static const char metadata[] =
    JSON({"saoms": "plugin", "abi": 3, "package": "patrol", "version": "0.1.0", "entry": "patrol_plugin", "classes": [
        {"contract": 1, "class": "patrol.Robot", "kind": "periodic",
         "doc": "Patrols along the edge of a rectangle, and keeps clear of the others. In a site with zones it asks for grants.",
         "properties": [
            {"name": "ID", "type": "string", "doc": "The robot's name.", "required": true, "nonEmpty": true, "unique": "robot"},
            {"name": "number", "type": "integer", "doc": "The robot's number.", "min": 1, "max": 4294967295,
             "required": true, "unique": "robot number", "speaker": true},
            {"name": "left", "type": "integer", "doc": "The first column of the rectangle.", "unit": "blocks", "min": 0,
             "max": 10000, "default": "0"},
            {"name": "top", "type": "integer", "doc": "The first row; the robot starts at the first block of both.",
             "unit": "blocks", "min": 0, "max": 10000, "default": "0"},
            {"name": "right", "type": "integer", "doc": "The last column.", "unit": "blocks", "min": 0, "max": 10000,
             "default": "10"},
            {"name": "bottom", "type": "integer", "doc": "The last row.", "unit": "blocks", "min": 0, "max": 10000,
             "default": "10"}],
         "publishes": [)
    TOPIC("POSTOPIC", "state", "Position") POSITION ROBOT_SPEAKS
    TOPIC("RLMSTOPIC", "state", "RobotList") ROBOT_LIST ROBOT_SPEAKS
    TOPIC("GRANTREQUESTTOPIC", "state", "GrantRequest") GRANT_REQUEST IF_ANY ROBOT_SPEAKS
    TOPIC("ELMSTOPIC", "event", "EventLuggage") EVENT_LUGGAGE "}], \"subscribes\": ["
    TOPIC("POSTOPIC", "state", "Position") POSITION "}," TOPIC("ELMSTOPIC", "event", "EventLuggage") EVENT_LUGGAGE "},"
    TOPIC("ZONETOPIC", "state", "Territory") TERRITORY IF_ANY "}," TOPIC("GRANTTOPIC", "state", "Grant") GRANT IF_ANY
    "}], \"services\": [], \"references\": [{\"name\": \"world\", \"interface\":" HARDWARE ", \"optional\": true}]}]}";

static const SaomsClassTable class_table = {
    .size = sizeof(SaomsClassTable),
    .construct = patrol_construct,
    .component = &component_table,
};

static const SaomsClassTable *const classes[] = {&class_table};

SAOMS_EXPORT const SaomsPluginTable *patrol_plugin(uint32_t version) {
    static SaomsPluginTable table;
    (void)version;
    table.size = sizeof table;
    table.version = SAOMS_ABI_VERSION;
    table.metadata = saoms_text(metadata);
    table.classes = classes;
    table.class_count = 1;
    return &table;
}
