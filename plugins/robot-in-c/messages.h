/* What the robots of the airport fleet say to each other, as far as the patrol uses it: schemas, structures, bytes.
 *
 * `saoms components saoms.CollisionMS --format json` shows the schema of each topic that a class or a loop uses. Order and spaces of the
 * members do not count, the order of the fields does.
 */

#ifndef PATROL_MESSAGES_H
#define PATROL_MESSAGES_H

#include "saoms_author.h"

/* Makes JSON a text of C. */
#define JSON(...) #__VA_ARGS__

#define BLOCK JSON({"name": "Block", "fields": [{"name": "x", "type": "int32"}, {"name": "y", "type": "int32"}]})

#define POSITION                                                                                            \
    JSON({"name": "Position", "key": "robot", "place": "block", "fields": [{"name": "robot",                \
        "type": "uint32"}, {"name": "block", "type":)                                                       \
    BLOCK JSON(}, {"name": "next", "type":) BLOCK JSON(}, {"name": "wanted", "type":) BLOCK                  \
    JSON(}, {"name": "priority", "type": {"name": "Priority", "fields": [                                   \
        {"name": "rank", "type": "uint64"}, {"name": "robot", "type": "uint32"}]}}]})

#define ROBOT_LIST                                                                                          \
    JSON({"name": "RobotList", "key": "robot", "place": "block", "fields": [{"name": "robot", "type": "uint32"},              \
        {"name": "active", "type": "bool"}, {"name": "battery", "type": "float64"},                         \
        {"name": "in_charge", "type": "bool"}, {"name": "asleep", "type": "bool"}, {"name": "charger", "type":) \
    BLOCK JSON(}, {"name": "period", "type": "uint64"}, {"name": "block", "type":) BLOCK      \
    JSON(}, {"name": "policy", "type": {"enumeration": "uint8", "values": {"SAFE": 0, "CLASSIC": 1}}},  \
        {"name": "began", "type": {"optional": "time"}}]})

#define EVENT_LUGGAGE                                                                                       \
    JSON({"name": "EventLuggage", "place": "from", "fields": [{"name": "robot", "type": "uint32"},                           \
        {"name": "luggage", "type": "uint32"}, {"name": "stage", "type": {"enumeration": "uint8",           \
        "values": {"REQUEST": 0, "INTEREST": 1, "RELEASE": 2, "TAKEN": 3, "DELIVERED": 4, "REFUSED": 5,     \
        "GIVEN_UP": 6}}}, {"name": "from", "type":)                                                         \
    BLOCK JSON(}, {"name": "to", "type":) BLOCK JSON(}, {"name": "block", "type":) BLOCK JSON(}]})

#define TERRITORY                                                                                           \
    JSON({"name": "Territory", "key": "zone", "fields": [{"name": "zone", "type": "uint32"},                \
        {"name": "term", "type": "uint64"}, {"name": "corner", "type":)                                     \
    BLOCK JSON(}, {"name": "width", "type": "uint32"}, {"name": "height", "type": "uint32"}]})

#define STEPS                                                                                               \
    JSON({"sequence": {"name": "Step", "fields": [{"name": "number", "type": "uint64"}, {"name": "block", "type":) \
    BLOCK JSON(}]}})

#define GRANT_REQUEST                                                                                       \
    JSON({"name": "GrantRequest", "key": "link", "place": "at", "fields": [{"name": "link", "type": "uint64"}, \
        {"name": "zone", "type": "uint32"}, {"name": "term", "type": "uint64"},                             \
        {"name": "robot", "type": "uint32"}, {"name": "incarnation", "type": "uint64"},                     \
        {"name": "number", "type": "uint64"}, {"name": "at", "type":)                                       \
    BLOCK JSON(}, {"name": "block", "type":) BLOCK JSON(}, {"name": "end", "type":) BLOCK JSON(}, {"name": "received", "type": "uint64"},            \
        {"name": "held", "type":) STEPS JSON(}, {"name": "goal", "type":) BLOCK                             \
    JSON(}, {"name": "charger", "type":) BLOCK JSON(}, {"name": "rank", "type": "uint64"},                  \
        {"name": "standing", "type": {"enumeration": "uint8", "values": {"MAKES_WAY": 0, "STAYS": 1, "LOST": 2, "ENTERS": 3}}}, \
        {"name": "ahead", "type": "uint32"}]})

#define GRANT                                                                                               \
    JSON({"name": "Grant", "key": "link", "place": "address", "fields": [{"name": "link", "type": "uint64"}, \
        {"name": "zone", "type": "uint32"}, {"name": "term", "type": "uint64"},                             \
        {"name": "robot", "type": "uint32"}, {"name": "incarnation", "type": "uint64"},                     \
        {"name": "heard", "type": "uint64"}, {"name": "address", "type":)                                   \
    BLOCK JSON(}, {"name": "steps", "type":) STEPS JSON(}, {"name": "waits_for", "type": "uint32"},         \
        {"name": "wanted", "type":)                                                                         \
    BLOCK JSON(}, {"name": "aside", "type":) BLOCK JSON(}, {"name": "aside_rank", "type": "uint64"}]})

#define PROGRESS JSON({"enumeration": "uint8", "values": {"RUNNING": 0, "DONE": 1, "FAILED": 2}})

#define ACTION                                                                                              \
    JSON({"name": "Action", "fields": [{"name": "kind", "type": {"enumeration": "uint8",                    \
        "values": {"MOVE": 0, "COLLECT": 1, "DEPOSIT": 2}}}, {"name": "block", "type":)                     \
    BLOCK JSON(}, {"name": "luggage", "type": "uint32"}]})

#define HARDWARE                                                                                            \
    JSON({"name": "saoms.Hardware", "operations": [                                                         \
        {"name": "enter", "arguments": [{"name": "robot", "type": "uint32"}, {"name": "name", "type": "string"}, \
        {"name": "block", "type":) BLOCK JSON(}], "reply":) BLOCK                                           \
    JSON(}, {"name": "area", "arguments": [], "reply": {"name": "Area", "fields": [                         \
        {"name": "width", "type": "uint32"}, {"name": "height", "type": "uint32"},                          \
        {"name": "blocked", "type": {"sequence": "uint64"}}]}},                                             \
        {"name": "begin", "arguments": [{"name": "robot", "type": "uint32"}, {"name": "action", "type":)    \
    ACTION JSON(}], "reply":) PROGRESS                                                                      \
    JSON(}, {"name": "poll", "arguments": [{"name": "robot", "type": "uint32"}], "reply":) PROGRESS         \
    JSON(}, {"name": "cancel", "arguments": [{"name": "robot", "type": "uint32"}], "reply": null},          \
        {"name": "retire", "arguments": [{"name": "robot", "type": "uint32"}], "reply":) BLOCK JSON(},      \
        {"name": "battery", "arguments": [{"name": "robot", "type": "uint32"}], "reply": {"optional": "float64"}}, \
        {"name": "isOnFloor", "arguments": [{"name": "robot", "type": "uint32"}], "reply": "bool"},         \
        {"name": "recall", "arguments": [{"name": "robot", "type": "uint32"}, {"name": "action", "type":)   \
    ACTION JSON(}], "reply": {"optional":) PROGRESS JSON(}}]})

/* The operations of the hardware, by their places. */
enum { ENTER = 0, BEGIN = 2, POLL = 3, RETIRE = 5, IS_ON_FLOOR = 7 };

/* How an action of the hardware goes. */
enum { RUNNING = 0, DONE = 1, FAILED = 2 };

/* What is said about luggage, as far as it is used here. */
enum { REQUEST = 0, REFUSED = 5 };

/* What a robot does when another one wants its block. */
enum { MAKES_WAY = 0, LOST = 2, ENTERS = 3 };

typedef struct Block {
    int32_t x, y;
} Block;

/* Which blocks a robot holds, `block` and `next`, and which it wants. */
typedef struct Position {
    uint32_t robot;
    Block block, next, wanted;
    /* With which right: the higher rank first, then the lower number. */
    uint64_t rank;
    uint32_t right_of;
} Position;

static inline int same(Block one, Block other) { return one.x == other.x && one.y == other.y; }

static inline void write_block(SaomsBuffer *buffer, Block block) {
    saoms_write_i32(buffer, block.x);
    saoms_write_i32(buffer, block.y);
}

static inline Block read_block(SaomsReader *reader) {
    Block block;
    block.x = saoms_read_i32(reader);
    block.y = saoms_read_i32(reader);
    return block;
}

static inline void write_position(SaomsBuffer *buffer, const Position *position) {
    saoms_write_u32(buffer, position->robot);
    write_block(buffer, position->block);
    write_block(buffer, position->next);
    write_block(buffer, position->wanted);
    saoms_write_u64(buffer, position->rank);
    saoms_write_u32(buffer, position->right_of);
}

static inline Position read_position(SaomsReader *reader) {
    Position position;
    position.robot = saoms_read_u32(reader);
    position.block = read_block(reader);
    position.next = read_block(reader);
    position.wanted = read_block(reader);
    position.rank = saoms_read_u64(reader);
    position.right_of = saoms_read_u32(reader);
    return position;
}

#endif /* PATROL_MESSAGES_H */
