/* How the patrol gets past the others: what robots agree on, in `saoms-components/src/robot/safe/traffic.rs`.
 *
 * A robot says which blocks it holds and which block it wants, and enters that in a later execution, once nobody else holds or wants it. Where a robot
 * of more right wants the same block, it wants nothing. Where a robot comes towards it, the patrol turns around.
 */

#include "patrol.h"

/* After so many executions in which it could not go on it turns around. */
#define PATIENCE 10

/* The way: along the edge of the rectangle. */

static int is_on_edge(const Patrol *patrol, Block block) {
    Block first = patrol->first, last = patrol->last;
    int inside = block.x >= first.x && block.x <= last.x && block.y >= first.y && block.y <= last.y;
    return inside && (block.x == first.x || block.x == last.x || block.y == first.y || block.y == last.y);
}

/* The block behind this one, in the direction of the patrol. */
static Block ahead(const Patrol *patrol, Block at, int direction) {
    Block first = patrol->first, last = patrol->last, to = at;
    if (at.y == first.y && (direction > 0 ? at.x < last.x : at.x > first.x)) {
        to.x += direction;
    } else if (at.y == last.y && (direction > 0 ? at.x > first.x : at.x < last.x)) {
        to.x -= direction;
    } else if (at.x == last.x) {
        to.y += direction;
    } else {
        to.y -= direction;
    }
    return to;
}

/* The others. */

static int holds(const Position *peer, Block block) { return same(peer->block, block) || same(peer->next, block); }

static int has_more_right(const Position *one, const Position *other) {
    if (one->rank != other->rank) {
        return one->rank > other->rank;
    }
    if (one->right_of != other->right_of) {
        return one->right_of < other->right_of;
    }
    return one->robot < other->robot;
}

/* Whether a robot speaks, and no other component in its name: for a robot that the fleet does not know, as one of another
 * program, that is the first one that does. */
static int is_of(const Patrol *patrol, const SaomsHostHandle *host, size_t place, uint32_t robot, uint32_t sender) {
    int64_t own;
    if (place < patrol->peer_count && patrol->speakers[place] == sender) {
        return 1;
    }
    own = host->functions->speaker(host->state, saoms_text("POSTOPIC"), robot);
    return own < 0 ? place == patrol->peer_count : own == sender;
}

SaomsStatus hear_positions(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error) {
    size_t at, place;
    const SaomsInbox *inbox;
    if (patrol->positions_heard >= host->inbox_count) {
        return SaomsStatus_OK;
    }
    inbox = &host->inboxes[patrol->positions_heard];
    for (at = 0; at < inbox->count; at++) {
        SaomsReader reader = saoms_reader(inbox->messages[at].bytes);
        Position peer = read_position(&reader);
        if (reader.failed || peer.robot == patrol->number) {
            continue;
        }
        for (place = 0; place < patrol->peer_count && patrol->peers[place].robot != peer.robot; place++) {
        }
        if (!is_of(patrol, host, place, peer.robot, inbox->messages[at].sender)) {
            continue;
        }
        if (place == MOST_PEERS) {
            return saoms_fail(error, "there are more robots than the patrol can know");
        }
        patrol->peers[place] = peer;
        patrol->speakers[place] = inbox->messages[at].sender;
        if (place == patrol->peer_count) {
            patrol->peer_count++;
        }
    }
    return SaomsStatus_OK;
}

/* The robot that holds the block, or null. */
static const Position *holder(const Patrol *patrol, Block block) {
    size_t place;
    for (place = 0; place < patrol->peer_count; place++) {
        if (holds(&patrol->peers[place], block)) {
            return &patrol->peers[place];
        }
    }
    return NULL;
}

/* A robot that wants the block, and has more right than `than` where that is not null. */
static const Position *wanting(const Patrol *patrol, Block block, const Position *than) {
    size_t place;
    for (place = 0; place < patrol->peer_count; place++) {
        const Position *peer = &patrol->peers[place];
        if (same(peer->wanted, block) && !holds(peer, block) && (than == NULL || has_more_right(peer, than))) {
            return peer;
        }
    }
    return NULL;
}

int may_enter(const Patrol *patrol) {
    const Position *own = &patrol->own;
    return !same(own->wanted, own->next) && same(own->wanted, patrol->said.wanted) &&
           holder(patrol, own->wanted) == NULL && wanting(patrol, own->wanted, NULL) == NULL;
}

/* Writes to the journal that it turns around, and why. */
static void turn_around(Patrol *patrol, const SaomsHostHandle *host, uint32_t robot) {
    SaomsValueView value;
    SaomsRecordView record;
    memset(&value, 0, sizeof value);
    value.kind = 1;
    value.bits = robot;
    memset(&record, 0, sizeof record);
    record.id = saoms_text("robot_in_the_way");
    record.text = saoms_text("robot {robot} is in its way");
    record.names = saoms_text("robot,");
    record.values = &value;
    record.count = 1;
    host->functions->journal(host->state, 0, &record);
    record.id = saoms_text("turns_around");
    record.text = saoms_text("turns around");
    record.names = saoms_text("");
    record.count = 0;
    host->functions->journal(host->state, 1, &record);
    host->functions->count(host->state, saoms_text("patrol.turns"), 1);
    patrol->direction = -patrol->direction;
    patrol->waited = 0;
}

void want(Patrol *patrol, const SaomsHostHandle *host) {
    Position *own = &patrol->own;
    Block at = own->next, to;
    const Position *asking = wanting(patrol, at, own), *ahead_of_it;
    own->rank = 0;
    own->right_of = patrol->number;
    own->wanted = at;
    if (!is_on_edge(patrol, at)) {
        return;
    }
    /* Who has to make way lends the right of the one that asks. */
    if (asking != NULL && asking->rank != IMMOVABLE) {
        own->rank = asking->rank;
        own->right_of = asking->right_of;
    }
    to = ahead(patrol, at, patrol->direction);
    ahead_of_it = holder(patrol, to);
    if (ahead_of_it != NULL) {
        int comes = same(ahead_of_it->wanted, at) || same(ahead_of_it->next, at);
        patrol->waited++;
        if (comes || ahead_of_it->rank == IMMOVABLE || patrol->waited > PATIENCE) {
            turn_around(patrol, host, ahead_of_it->robot);
            to = ahead(patrol, at, patrol->direction);
        }
    }
    if (wanting(patrol, to, own) == NULL) {
        own->wanted = to;
    }
}
