/* How the patrol drives in a site with zones: the protocol of `docs/zones.md`, as
 * `saoms-components/src/zone/passage.rs` keeps it.
 *
 * It holds the block where it is, and enters another one only with a grant. It tells each zone what it holds of it, and
 * repeats that until the zone confirms it; what it does not name there is released for ever.
 *
 * It does not follow `aside`: at the edge of a zone it makes way for nobody over the edge, and turns around when it has
 * waited for long. Robots that wait for it there get on later, and just as safely.
 */

#include "patrol.h"

/* After so many executions it repeats a request that its zone did not confirm; sooner while it waits. */
#define REPEAT 4
#define REPEAT_WAITING 2

/* After so many executions without a grant it turns around: something that cannot move may be on its corner. */
#define PATIENCE_FOR_GRANTS 60
/* Zones up to this number of blocks away have to know where it wants to go. */
#define NEAR 4

/* What it goes for. */

static Block corner(const Patrol *patrol, int index) {
    Block block;
    block.x = index == 1 || index == 2 ? patrol->last.x : patrol->first.x;
    block.y = index >= 2 ? patrol->last.y : patrol->first.y;
    return block;
}

/* Goes for the next corner, once it is at this one or has waited for too long. */
static void aim(Patrol *patrol, const SaomsHostHandle *host) {
    Passage *passage = &patrol->passage;
    int is_there = same(patrol->own.block, corner(patrol, passage->corner));
    int is_late = patrol->waited > PATIENCE_FOR_GRANTS;
    if (!is_there && !is_late) {
        return;
    }
    if (is_late) {
        patrol->direction = -patrol->direction;
        host->functions->count(host->state, saoms_text("patrol.turns"), 1);
    }
    passage->corner = (passage->corner + patrol->direction + 4) % 4;
    passage->since = host->functions->now(host->state);
    patrol->waited = 0;
}

/* The rank of its way, as that of a robot on its way home: of two the older one goes first. */
static uint64_t rank(const Patrol *patrol) {
    return ((uint64_t)1 << 56) | ((((uint64_t)1 << 56) - 1) - (patrol->passage.since >> 8));
}

/* What it holds. */

void begin_passage(Patrol *patrol, const SaomsHostHandle *host, int enters) {
    Passage *passage = &patrol->passage;
    uint64_t date = host->functions->date(host->state), now = host->functions->now(host->state);
    /* Greater than that of each robot of its number before. What was granted to those does not count. */
    passage->incarnation = date == UINT64_MAX ? now : date;
    passage->since = now;
    passage->held[0].zone = 0;
    passage->held[0].number = 0;
    passage->held[0].block = patrol->own.block;
    passage->held_count = 1;
    passage->enters = enters;
}

const Block *granted(const Patrol *patrol) {
    return patrol->passage.held_count > 1 ? &patrol->passage.held[1].block : NULL;
}

void release_left(Patrol *patrol) {
    Passage *passage = &patrol->passage;
    size_t at = 0;
    while (at < passage->held_count && !same(passage->held[at].block, patrol->own.block)) {
        at++;
    }
    if (at < passage->held_count) {
        passage->held_count -= at;
        memmove(passage->held, passage->held + at, passage->held_count * sizeof passage->held[0]);
    }
}

void release_ahead(Patrol *patrol) {
    size_t begun = patrol->is_moving ? 2 : 1;
    if (patrol->passage.held_count > begun) {
        patrol->passage.held_count = begun;
    }
}

/* It leaves: what was granted and is on its way is released, too. */
void take_no_more(Patrol *patrol) {
    size_t zone;
    for (zone = 0; zone < patrol->passage.zone_count; zone++) {
        patrol->passage.zones[zone].received = UINT64_MAX;
    }
}

/* What zones say. */

static int is_beside(Block one, Block other) {
    return labs((long)one.x - other.x) + labs((long)one.y - other.y) == 1;
}

static SaomsStatus hear_territory(Passage *passage, const SaomsHostHandle *host, const SaomsMessageView *message,
                                  SaomsSink error) {
    SaomsReader bytes = saoms_reader(message->bytes), *reader = &bytes;
    uint32_t number = saoms_read_u32(reader);
    Zone *zone;
    SaomsStatus status;
    Area area;
    area.term = saoms_read_u64(reader);
    area.corner = read_block(reader);
    area.width = saoms_read_u32(reader);
    area.height = saoms_read_u32(reader);
    /* The fleet knows all its zones: nobody else grants anything, whatever it says. */
    if (reader->failed || host->functions->speaker(host->state, saoms_text("ZONETOPIC"), number) != message->sender) {
        return SaomsStatus_OK;
    }
    status = learn_area(passage, number, &area, error);
    zone = zone_of(passage, number);
    if (zone != NULL) {
        zone->speaker = message->sender;
    }
    return status;
}

static void hear_grant(Patrol *patrol, const SaomsMessageView *message) {
    SaomsReader bytes = saoms_reader(message->bytes), *reader = &bytes;
    Passage *passage = &patrol->passage;
    uint32_t number, robot;
    uint64_t term, incarnation, heard;
    size_t count;
    Zone *zone;
    saoms_read_u64(reader);
    number = saoms_read_u32(reader);
    term = saoms_read_u64(reader);
    robot = saoms_read_u32(reader);
    incarnation = saoms_read_u64(reader);
    heard = saoms_read_u64(reader);
    read_block(reader);
    zone = zone_of(passage, number);
    if (reader->failed || robot != patrol->number || incarnation != passage->incarnation || zone == NULL ||
        !zone->is_zone || term != zone->area.term || message->sender != zone->speaker) {
        return;
    }
    if (heard > zone->heard) {
        zone->heard = heard;
    }
    for (count = saoms_read_count(reader); count > 0; count--) {
        Step step;
        Block end = passage->held[passage->held_count - 1].block;
        step.zone = number;
        step.number = saoms_read_u64(reader);
        step.block = read_block(reader);
        if (reader->failed || step.number <= zone->received) {
            continue;
        }
        /* Heard once, it is held or released for ever. */
        zone->received = step.number;
        if (passage->enters) {
            if (same(step.block, end)) {
                passage->held[0] = step;
                passage->enters = 0;
            }
        } else if (is_beside(step.block, end) && passage->held_count < MOST_HELD) {
            passage->held[passage->held_count++] = step;
        }
    }
}

SaomsStatus hear_zones(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    const Passage *passage = &patrol->passage;
    const SaomsInbox *inbox;
    size_t at;
    SaomsStatus status = SaomsStatus_OK;
    if (passage->territories_heard < host->inbox_count) {
        inbox = &host->inboxes[passage->territories_heard];
        for (at = 0; at < inbox->count && status == SaomsStatus_OK; at++) {
            status = hear_territory(&patrol->passage, host, &inbox->messages[at], error);
        }
    }
    if (passage->grants_heard < host->inbox_count) {
        inbox = &host->inboxes[passage->grants_heard];
        for (at = 0; at < inbox->count; at++) {
            hear_grant(patrol, &inbox->messages[at]);
        }
    }
    return status;
}

/* What it says to zones. */

static SaomsBytes request(const Patrol *patrol, const Zone *zone, int standing, SaomsBuffer *message) {
    const Passage *passage = &patrol->passage;
    Block end = passage->held[passage->held_count - 1].block, goal = corner(patrol, passage->corner);
    uint32_t count = 0;
    size_t at;
    for (at = 0; at < passage->held_count && !passage->enters; at++) {
        count += passage->held[at].zone == zone->number;
    }
    /* A zone that is not near has nothing to grant. */
    if (standing != MAKES_WAY || passage->enters || (count == 0 && !contains(&zone->area, end, NEAR))) {
        goal = end;
    }
    saoms_write_u64(message, (uint64_t)zone->number << 32 | patrol->number);
    saoms_write_u32(message, zone->number);
    saoms_write_u64(message, zone->area.term);
    saoms_write_u32(message, patrol->number);
    saoms_write_u64(message, passage->incarnation);
    saoms_write_u64(message, zone->requests);
    write_block(message, closest(&zone->area, passage->held[0].block));
    write_block(message, passage->held[0].block);
    write_block(message, end);
    saoms_write_u64(message, zone->received);
    saoms_write_u32(message, count);
    for (at = 0; at < passage->held_count && count > 0; at++) {
        if (passage->held[at].zone == zone->number) {
            saoms_write_u64(message, passage->held[at].number);
            write_block(message, passage->held[at].block);
        }
    }
    write_block(message, goal);
    write_block(message, patrol->first);
    saoms_write_u64(message, same(goal, end) ? 0 : rank(patrol));
    saoms_write_u8(message, (uint8_t)standing);
    saoms_write_u32(message, 0);
    return saoms_written(message);
}

/* What another zone granted, before this one had the block, it has received, too. */
static void note_received(const Passage *passage, Zone *zone) {
    size_t at;
    for (at = 0; at < passage->held_count; at++) {
        if (passage->held[at].zone == zone->number && passage->held[at].number > zone->received) {
            zone->received = passage->held[at].number;
        }
    }
}

SaomsStatus ask_zones(Patrol *patrol, const SaomsHostHandle *host, int standing, SaomsSink error) {
    Passage *passage = &patrol->passage;
    int waits = passage->held_count == 1, again;
    size_t at;
    patrol->waited = waits && !patrol->is_moving ? patrol->waited + 1 : 0;
    aim(patrol, host);
    again = ++passage->silent >= (waits ? REPEAT_WAITING : REPEAT);
    if (again) {
        passage->silent = 0;
    }
    for (at = 0; at < passage->zone_count; at++) {
        Zone *zone = &passage->zones[at];
        uint8_t memory[REQUEST_BYTES];
        SaomsBuffer message = saoms_writer(memory, sizeof memory);
        SaomsBytes bytes;
        uint64_t key = (uint64_t)zone->number << 32 | patrol->number;
        SaomsStatus status;
        if (!zone->is_zone) {
            continue;
        }
        note_received(passage, zone);
        bytes = request(patrol, zone, standing, &message);
        if (bytes.length != zone->said_length || memcmp(bytes.data, zone->said, bytes.length) != 0) {
            /* Something changed, so it is a new request. */
            zone->requests++;
            message = saoms_writer(memory, sizeof memory);
            bytes = request(patrol, zone, standing, &message);
            memcpy(zone->said, bytes.data, bytes.length);
            zone->said_length = bytes.length;
        } else if (!again || zone->heard >= zone->requests) {
            continue;
        }
        if ((status = host->functions->send(host->state, passage->requests, &key, bytes, error)) != SaomsStatus_OK) {
            return status;
        }
    }
    return SaomsStatus_OK;
}
