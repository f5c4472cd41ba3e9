/* Contact of free bodies with walls, solids and each other, beside the mechanics of rigid bodies. A step in which
   bodies have been given motions; no liquid is near. Lengths in spacings. Runs on any number of ranks. */
#include "../../src/bodies/bodies_impl.h"
#include "setup.h"
#include "check.h"

#define BOX                                                                                                            \
  "-dimension 2 -spacing 1 -box_lower -30,0 -box_upper 30,40 -box_ymin wall -bodies a -a_lower -30,36 -a_upper "       \
  "-26,40 "
#define BLOCK "-s_lower -3,%g -s_upper 3,6 -s_mass 18000 "
#define PAIR                                                                                                           \
  BOX "-solids s,t -s_shape sphere -s_radius 4 -s_center -4.05,20 -s_mass 30000 -t_shape sphere -t_radius 4 "          \
      "-t_center 4.05,20 -t_mass 60000 "
#define DT    0.1 /* s */
#define LEAVE 1   /* s, in which a gap may close */

/* Opens a scene of free bodies with these velocities (m/s) along x and y and rates (rad/s), touches them, and leaves
   the motions and impulses of both, [2][RIGID_MOTIONS]. */
static PetscErrorCode Touch(const char options[], const PetscReal given[][DIM], PetscReal motion[], PetscReal sum[],
                            HitTogether *hit)
{
  const PetscInt turning = RIGID_MOTIONS - 1;
  HitTogether    none    = {.seen = PETSC_FALSE};
  PetscReal      before[SCENE_MAX_BODIES * RIGID_MOTIONS];
  Setup          s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(PetscArrayzero(motion, RIGID_MOTIONS * SceneSolidCount(s.scene)));
  for (PetscInt k = 0; k < SceneSolidCount(s.scene); k++) {
    for (PetscInt d = 0; d < 2; d++) motion[RIGID_MOTIONS * k + d] = given[k][d];
    motion[RIGID_MOTIONS * k + turning] = given[k][2];
  }
  PetscCall(PetscArraycpy(before, motion, RIGID_MOTIONS * SceneSolidCount(s.scene)));
  PetscCall(FreeTouch(s.cloud, 0, DT, DT, LEAVE, before, motion, sum, hit ? hit : &none));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A block comes down on the floor: over a gap it keeps what closes it in LEAVE, without one it stops;
   going up it is free. The floor gives what its mass lost, and no torque. */
static PetscErrorCode TestFloor(void)
{
  const PetscReal down[1][DIM] = {{0.5, -1, 0}}, up[1][DIM] = {{0, 1, 0}}, gap[] = {0, 0.25}, after[] = {0, -0.25};
  PetscReal       motion[RIGID_MOTIONS], sum[RIGID_MOTIONS];
  char            options[512];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(PetscSNPrintf(options, sizeof(options), BOX "-solids s " BLOCK, (double)gap[k]));
    PetscCall(Touch(options, down, motion, sum, NULL));
    CHECK_CLOSE(motion[1], after[k], 1e-6, "velocity_onto_a_floor");
    CHECK_CLOSE(sum[1] / (18000 * (1 + after[k])), 1, 1e-6, "impulse_of_a_floor");
    CHECK_CLOSE(motion[0], 0.5, 1e-9, "a_floor_without_friction_lets_slide");
    CHECK_CLOSE(motion[RIGID_MOTIONS - 1], 0, 1e-6, "a_floor_does_not_turn_a_block");
    PetscCall(Touch(options, up, motion, sum, NULL));
    CHECK_CLOSE(motion[1], 1, 1e-12, "what_leaves_a_floor_is_free");
  }
  PetscCall(PetscSNPrintf(options, sizeof(options), BOX "-solids s " BLOCK, 2.5));
  PetscCall(Touch(options, down, motion, sum, NULL));
  CHECK_CLOSE(sum[1], 0, 0, "a_floor_far_away");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Coulomb: the floor takes at most the share of what it presses with, and no more than ends the sliding. A block that
   cannot turn, on a floor that moves: relative to that. */
static PetscErrorCode TestFriction(void)
{
  const PetscReal given[1][DIM] = {{2, -1, 0}};
  PetscReal       motion[RIGID_MOTIONS], sum[RIGID_MOTIONS];

  PetscFunctionBegin;
  PetscCall(Touch(BOX "-solids s -s_lower -3,0 -s_upper 3,6 -s_mass 18000 -s_turns 0 -s_friction 0.3 ", given, motion,
                  sum, NULL));
  CHECK_CLOSE(motion[0], 2 - 0.3, 1e-6, "friction_is_a_share_of_the_pressure");
  PetscCall(Touch(BOX "-solids s -s_lower -3,0 -s_upper 3,6 -s_mass 18000 -s_turns 0 -s_friction 5 ", given, motion,
                  sum, NULL));
  CHECK_CLOSE(motion[0], 0, 1e-6, "friction_holds");
  PetscCall(Touch(BOX "-box_ymin_velocity 3,0 -solids s -s_lower -3,0 -s_upper 3,6 -s_mass 18000 -s_turns 0 "
                      "-s_friction 0.3 ",
                  given, motion, sum, NULL));
  CHECK_CLOSE(motion[0], 2 + 0.3, 1e-6, "a_floor_that_moves_takes_along");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two balls of one and two masses: after a central hit they have Newton's velocities, and both impulses are one. Of a
   hit with friction the momentum and the angular momentum stay. */
static PetscErrorCode TestPair(void)
{
  const PetscReal restitution[] = {0.5, 1}, given[2][DIM] = {{2, 0, 0}, {-1, 0, 0}},
                  oblique[2][DIM] = {{2, 1, 0.2}, {0}};
  PetscReal motion[2 * RIGID_MOTIONS], sum[2 * RIGID_MOTIONS], spin = 0;
  char      options[512];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(PetscSNPrintf(options, sizeof(options), PAIR "-s_restitution %g -t_restitution %g ",
                            (double)restitution[k], (double)restitution[k]));
    PetscCall(Touch(options, given, motion, sum, NULL));
    CHECK_CLOSE(motion[RIGID_MOTIONS] - motion[0], 3 * restitution[k], 1e-3, "restitution_of_two_balls");
    CHECK_CLOSE(motion[0] + 2 * motion[RIGID_MOTIONS], 0, 1e-9, "momentum_of_two_balls");
    CHECK_CLOSE(sum[0] + sum[RIGID_MOTIONS], 0, 1e-6, "both_get_one_impulse");
  }
  PetscCall(
    Touch(PAIR "-s_friction 0.4 -t_friction 0.4 -s_restitution 1 -t_restitution 1 ", oblique, motion, sum, NULL));
  CHECK_CLOSE(motion[1] + 2 * motion[RIGID_MOTIONS + 1], 1, 1e-9, "momentum_of_an_oblique_hit");
  CHECK(motion[RIGID_MOTIONS + 1] > 0.05, "an_oblique_hit_takes_along");
  for (PetscInt k = 0; k < 2; k++) /* impulses about each centre, and those of the momenta, about the middle */
    spin += sum[RIGID_MOTIONS * (k + 1) - 1] + (k ? 4.05 : -4.05) * sum[RIGID_MOTIONS * k + 1];
  CHECK_CLOSE(spin / (4.05 * sum[1]), 0, 1e-6, "angular_momentum_of_an_oblique_hit");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A driven solid pushes a free one to its own velocity; two blocks in a row are hit as one by the wall behind them, and
   a ball between a wall and a ball that hits it is told. */
static PetscErrorCode TestChain(void)
{
  const PetscReal rest[2][DIM] = {{0}, {0}}, fall[2][DIM] = {{0, -1, 0}, {0, -1, 0}}, onto[2][DIM] = {{0}, {0, -1, 0}};
  PetscReal       motion[2 * RIGID_MOTIONS], sum[2 * RIGID_MOTIONS];
  HitTogether     hit = {.seen = PETSC_FALSE};

  PetscFunctionBegin;
  PetscCall(Touch(BOX "-solids s,p -s_lower -3,10 -s_upper 3,16 -s_mass 18000 -p_lower -5,4 -p_upper 5,10 "
                      "-p_velocity 0,2 ",
                  rest, motion, sum, NULL));
  CHECK_CLOSE(motion[1], 2, 1e-6, "a_driven_solid_pushes");
  CHECK_CLOSE(sum[1] / (18000 * 2), 1, 1e-6, "by_the_momentum_that_it_gives");
  PetscCall(Touch(BOX "-solids s,t -s_lower -3,0 -s_upper 3,6 -s_mass 18000 -t_lower -2,6 -t_upper 2,10 -t_mass 8000 ",
                  fall, motion, sum, NULL));
  CHECK_CLOSE(PetscAbsReal(motion[1]) + PetscAbsReal(motion[RIGID_MOTIONS + 1]), 0, 1e-6, "a_stack_comes_to_rest");
  CHECK_CLOSE((sum[1] + sum[RIGID_MOTIONS + 1]) / 26000, 1, 1e-6, "the_floor_bears_all_of_it");
  PetscCall(Touch(BOX "-solids s,t -s_shape sphere -s_radius 4 -s_center 0,4 -s_mass 30000 -s_restitution 1 -t_shape "
                      "sphere -t_radius 4 -t_center 0,12.02 -t_mass 30000 -t_restitution 1 ",
                  onto, motion, sum, &hit));
  CHECK(hit.seen && hit.body == 0 && hit.by[0] + hit.by[1] < 1, "hit_between_a_wall_and_a_ball");
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestFloor());
  PetscCall(TestFriction());
  PetscCall(TestPair());
  PetscCall(TestChain());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
