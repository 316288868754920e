/* answer_test.c - a request that has to change the world is carried out again by a reactor that is alone. */
#include "server/jobs/answer.h"

#include "server/jobs/reactor.h"
#include "tests/test.h"

TEST(request_that_shares_the_world_is_carried_out_again_when_it_has_to_change_it)
{
    static struct lanes lanes;
    static struct gate world;
    static struct reactor r;
    CHECK(lanes_init(&lanes, 2));
    gate_init(&world, &lanes);
    CHECK(loop_init(&r.loop, &world, 0));
    struct answer shares = {.reactor = &r}, alone = {.reactor = &r}, nobody = {0};
    loop_enter(&r.loop);
    CHECK(!world_alone(&shares));
    CHECK(shares.next == ANSWER_WAIT && shares.wait_for == WAIT_NOTHING);
    loop_alone(&r.loop);
    CHECK(world_alone(&alone) && alone.next == ANSWER_DONE);
    CHECK(world_alone(&nobody) && nobody.next == ANSWER_DONE);
    loop_leave(&r.loop);
    loop_clear(&r.loop);
    lanes_clear(&lanes);
}
