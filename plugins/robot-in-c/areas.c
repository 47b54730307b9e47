/* Which zone a block has, as far as the patrol knows: `saoms-components/src/zone/territories.rs` in C.
 *
 * Where borders change, a block gets another zone, in a higher term. What the patrol has told that zone counts from
 * then on: it takes no grant of an earlier one for the block any more, also if messages of that come late, and if its
 * present zone is not known.
 */

#include "patrol.h"

int contains(const Area *area, Block block, int64_t margin) {
    int64_t x = (int64_t)block.x - area->corner.x, y = (int64_t)block.y - area->corner.y;
    return x >= -margin && y >= -margin && x < area->width + margin && y < area->height + margin;
}

static int32_t within(int32_t value, int32_t from, uint32_t length) {
    int64_t last = (int64_t)from + length - 1;
    return value < from ? from : value > last ? (int32_t)last : value;
}

/* The block of a zone that is closest to a block. */
Block closest(const Area *area, Block block) {
    block.x = within(block.x, area->corner.x, area->width);
    block.y = within(block.y, area->corner.y, area->height);
    return block;
}

/* How many numbers two ranges share. */
static uint64_t overlap(int64_t from, uint32_t length, int64_t other_from, uint32_t other_length) {
    int64_t end = from + length, other_end = other_from + other_length;
    int64_t shared = (end < other_end ? end : other_end) - (from > other_from ? from : other_from);
    return shared > 0 ? (uint64_t)shared : 0;
}

/* How many blocks two zones share. */
static uint64_t shared(const Area *one, const Area *other) {
    return overlap(one->corner.x, one->width, other->corner.x, other->width) *
           overlap(one->corner.y, one->height, other->corner.y, other->height);
}

Zone *zone_of(Passage *passage, uint32_t number) {
    size_t at;
    for (at = 0; at < passage->zone_count; at++) {
        if (passage->zones[at].number == number) {
            return &passage->zones[at];
        }
    }
    return NULL;
}

/* Whether the zone had one of its blocks, or its number, before another zone of which it has heard. */
static int is_former(const Passage *passage, uint32_t number, const Area *area) {
    size_t at;
    for (at = 0; at < passage->zone_count; at++) {
        const Zone *zone = &passage->zones[at];
        int is_other = zone->is_zone && shared(&zone->area, area) > 0;
        if (zone->area.term >= area->term && (zone->number == number || is_other)) {
            return 1;
        }
    }
    for (at = 0; at < passage->former_count; at++) {
        if (passage->former[at].term >= area->term && shared(&passage->former[at], area) > 0) {
            return 1;
        }
    }
    return 0;
}

/* The zones that this one takes the place of are none any more. What was said of their blocks counts still, until the
 * present zones of all of these are known. */
static SaomsStatus take_place(Passage *passage, uint32_t number, const Area *area, SaomsSink error) {
    size_t at;
    for (at = 0; at < passage->zone_count; at++) {
        Zone *zone = &passage->zones[at];
        if (!zone->is_zone || (zone->number != number && shared(&zone->area, area) == 0)) {
            continue;
        }
        if (passage->former_count == MOST_FORMER) {
            return saoms_fail(error, "borders of zones changed more often than the patrol can remember");
        }
        passage->former[passage->former_count++] = zone->area;
        zone->is_zone = 0;
    }
    return SaomsStatus_OK;
}

static void forget_former(Passage *passage) {
    size_t at, other, kept = 0;
    for (at = 0; at < passage->former_count; at++) {
        const Area former = passage->former[at];
        uint64_t known = 0;
        for (other = 0; other < passage->zone_count; other++) {
            known += passage->zones[other].is_zone ? shared(&former, &passage->zones[other].area) : 0;
        }
        if (known < shared(&former, &former)) {
            passage->former[kept++] = former;
        }
    }
    passage->former_count = kept;
}

/* Notes in which zones the blocks are that it holds: it tells these, whichever zone granted them. */
static void find_zones(Passage *passage, const Area *area) {
    size_t at, zone;
    for (at = 0; at < passage->held_count; at++) {
        Step *step = &passage->held[at];
        if (step->zone == 0 && !contains(area, step->block, 0)) {
            continue;
        }
        step->zone = 0;
        for (zone = 0; zone < passage->zone_count; zone++) {
            if (passage->zones[zone].is_zone && contains(&passage->zones[zone].area, step->block, 0)) {
                step->zone = passage->zones[zone].number;
            }
        }
    }
}

SaomsStatus learn_area(Passage *passage, uint32_t number, const Area *area, SaomsSink error) {
    Zone *zone = zone_of(passage, number);
    SaomsStatus status;
    if (is_former(passage, number, area)) {
        return SaomsStatus_OK;
    }
    if ((status = take_place(passage, number, area, error)) != SaomsStatus_OK) {
        return status;
    }
    if (zone == NULL) {
        if (passage->zone_count == MOST_ZONES) {
            return saoms_fail(error, "there are more zones than the patrol can know");
        }
        zone = &passage->zones[passage->zone_count++];
        zone->number = number;
        passage->has_zones = 1;
    }
    /* It has to hear what this robot holds: the next request has the new term, and grants of before count no more. */
    zone->heard = 0;
    zone->is_zone = 1;
    zone->area = *area;
    forget_former(passage);
    find_zones(passage, area);
    return SaomsStatus_OK;
}
