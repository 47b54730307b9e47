/* The patrol: what it knows, and how it gets past the others. */

#ifndef PATROL_H
#define PATROL_H

#include "messages.h"

/* The most robots that it knows. */
#define MOST_PEERS 256

/* The right of one that cannot move any more. */
#define IMMOVABLE UINT64_MAX

/* The most zones that it knows, and the most blocks that it holds. */
#define MOST_ZONES 64
#define MOST_HELD 24
/* The most former zones with blocks whose present zone it does not know. */
#define MOST_FORMER 64

/* Enough for a request to a zone with `MOST_HELD` steps. */
#define REQUEST_BYTES 640

/* A block that it holds: a step that a zone granted, or number 0, where it stood when it began. */
typedef struct Step {
    uint32_t zone;
    uint64_t number;
    Block block;
} Step;

/* The blocks of a zone, and its term. */
typedef struct Area {
    uint64_t term;
    Block corner;
    uint32_t width, height;
} Area;

/* What it knows of a zone. */
typedef struct Zone {
    uint32_t number;
    /* The component that speaks for it. */
    uint32_t speaker;
    /* False once other zones have its blocks. */
    int is_zone;
    Area area;
    /* The highest number of a step that it received; all of these that it does not hold are released. */
    uint64_t received;
    /* The number of its newest request, that of the newest one that the zone took in, and the bytes of the former. */
    uint64_t requests, heard;
    uint8_t said[REQUEST_BYTES];
    size_t said_length;
} Zone;

/* Its way through the zones of its site. */
typedef struct Passage {
    int has_zones;
    uint32_t requests, territories_heard, grants_heard;
    uint64_t incarnation;
    /* The blocks that it holds, the one where it is first. */
    Step held[MOST_HELD];
    size_t held_count;
    /* It is not on the floor: the first block is the one where it waits to enter it, and it holds none. */
    int enters;
    Zone zones[MOST_ZONES];
    size_t zone_count;
    Area former[MOST_FORMER];
    size_t former_count;
    /* Executions since it repeated its requests, and all. */
    int silent;
    uint64_t executions;
    /* The corner of the rectangle where it goes, from 0 to 3, and since when. */
    int corner;
    uint64_t since;
} Passage;

typedef struct Patrol {
    /* What the composite says. */
    char name[64];
    uint32_t number;
    Block first, last;
    /* What `initialize` is given. */
    uint32_t positions, robots, luggage;
    uint32_t positions_heard, luggage_heard;
    uint32_t world;
    int has_world, has_entered, is_moving;
    /* What it says, and said last. */
    Position own, said;
    Position peers[MOST_PEERS];
    size_t peer_count;
    /* The components that speak for them. */
    uint32_t speakers[MOST_PEERS];
    /* 1 or -1. */
    int direction;
    int waited;
    uint64_t moves;
    Passage passage;
} Patrol;

/* Takes in where the others are and what they want. */
SaomsStatus hear_positions(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error);

/* Whether it may enter the block that it wants: nobody else holds that or wants it. */
int may_enter(const Patrol *patrol);

/* Decides which block to want. */
void want(Patrol *patrol, const SaomsHostHandle *host);

/* In a site with zones (areas.c): */

/* Whether an area, with so many blocks around it, has a block. */
int contains(const Area *area, Block block, int64_t margin);

/* The block of an area that is closest to a block. */
Block closest(const Area *area, Block block);

/* The zone of a number that it has heard of, or null. */
Zone *zone_of(Passage *passage, uint32_t number);

/* Learns the area of a zone, unless that was a zone before others of which it has heard. */
SaomsStatus learn_area(Passage *passage, uint32_t number, const Area *area, SaomsSink error);

/* The same (zones.c): */

/* It is on the floor, and holds the block where it is; or it wants to enter the floor there, and holds none. */
void begin_passage(Patrol *patrol, const SaomsHostHandle *host, int enters);

/* Takes in what zones say. */
SaomsStatus hear_zones(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error);

/* The block that it may enter next, or null. */
const Block *granted(const Patrol *patrol);

/* Releases the blocks that it has left, and those that it has not begun to enter. */
void release_left(Patrol *patrol);
void release_ahead(Patrol *patrol);
/* It leaves: what was granted and is on its way is released, too. */
void take_no_more(Patrol *patrol);

/* Tells zones what it holds and where it wants to go, where that changed or was not confirmed. */
SaomsStatus ask_zones(Patrol *patrol, const SaomsHostHandle *host, int standing, SaomsSink error);

#endif /* PATROL_H */
