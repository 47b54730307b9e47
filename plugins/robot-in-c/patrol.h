/* The patrol: what it knows, and how it gets past the others. */

#ifndef PATROL_H
#define PATROL_H

#include "messages.h"

/* The most robots that it knows. */
#define MOST_PEERS 256

/* The right of one that cannot move any more. */
#define IMMOVABLE UINT64_MAX

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
    /* 1 or -1. */
    int direction;
    int waited;
    uint64_t moves;
} Patrol;

/* Takes in where the others are and what they want. */
SaomsStatus hear_positions(Patrol *patrol, const SaomsHostHandle *host, SaomsSink error);

/* Whether it may enter the block that it wants: nobody else holds that or wants it. */
int may_enter(const Patrol *patrol);

/* Decides which block to want. */
void want(Patrol *patrol, const SaomsHostHandle *host);

#endif /* PATROL_H */
