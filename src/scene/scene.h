/* Floor 1: the scene as data. Named bodies of liquid, each a shape with a material and an initial velocity field; body
   forces.

   -bodies film,drop  and, for each body <b>:
   -<b>_shape box|sphere|cylinder|ellipsoid|half_space|wave|thread|stl, its sizes, -<b>_density, -<b>_viscosity,
   -<b>_tension, -<b>_color,
   -<b>_viscosity_model newtonian|power_law|carreau|herschel_bulkley and its numbers (viscosity.c),
   -<b>_velocity (uniform part), -<b>_velocity_type uniform|rotation|strain|taylor_green|shear and its numbers (added to
   the uniform part). Every shape is cut by the box and by the solids.

   -<b>_type emitter: the body is not there at the start; its shape is filled anew, with its velocity, each _interval
   (s) from _start (s) on, _count times (0: without end): a train of drops. The default interval is the shape's length
   along the velocity over the speed, so that a box or cylinder of a whole number of spacings gives a jet without gaps.
   Liquid inside the shape keeps the velocity. _modulation e and _modulation_frequency f (Hz): the speed is v (1 + e sin
   2 pi f t).

   -solids step,ramp  and, for each solid <s>, -<s>_shape and its sizes: obstacles, no-slip as far as the viscous form
   makes the walls of the box so. They may touch and overlap each other and the faces of the box. They are fixed or move
   as their options say (motion.c): -<s>_velocity, -<s>_oscillation_amplitude, _frequency, _phase, -<s>_rotation_rate,
   _rotation_center, _motion_file; what is asked about them is so at the time set last (SceneMoveSolids). Or they are
   free bodies, which the liquid moves (free.c): -<s>_mass, _inertia, _turns.

   -fine core,rim  and, for each region <r>, -<r>_shape and its sizes: where the spacing is -spacing, with
   -spacing_coarse farther away (SceneSpacing).

   Sizes (m): box _lower, _upper (default: the simulation box); sphere _center, _radius; cylinder _center, _radius,
   _axis x|y|z or a vector, _height (0: infinite); ellipsoid _center, _radii; half_space _point, _normal (out of the
   liquid); wave _lower, _upper (as a box, the last number of _upper is the mean level), _wave_amplitude a,
   _wave_length (along x; a whole number of half waves in the width). The top of a wave is at a cos k(x - x_lower) + k
   a^2/2 coth(kH) cos 2k(x - x_lower) from the level: a cosine and what a standing wave of finite height adds in second
   order. The lattice packing moves its points there along the field of the linear wave, which keeps every volume, so
   that the amplitude may be a fraction of the spacing; thread (three dimensions only): an infinite cylinder, _center,
   _radius, _axis, whose radius has waves of _wave_amplitude and _wave_length, thickest at the center, made like a wave;
   stl: a closed surface of triangles from the file _file, times _scale, moved by _offset; its distance comes from a
   table with a node a half spacing, exact to some tenths of a spacing at edges; in two dimensions its section at z = 0.
   Velocities: rotation _rotation_rate (rad/s), _rotation_center;
   strain _strain_rate (1/s, diagonal or full gradient), _strain_center; shear _shear_rate (1/s), _shear_direction,
   _shear_normal, _shear_center; taylor_green _taylor_green_amplitude (m/s), _taylor_green_wavelength (m, default: the
   width of the box). In two dimensions a sphere is a circle and so on; z is ignored. Rings: a shape in two dimensions
   is the section of a body of revolution: a sphere off the axis is a torus, a box a tube, a half space along an
   inclined plane a cone; a cylinder must be about the axis. */
#ifndef ISPH_SCENE_H
#define ISPH_SCENE_H

#include "../domain/domain.h"

#define SCENE_MAX_BODIES 64

typedef struct {
  PetscReal density;   /* rho_0, kg/m3 */
  PetscReal viscosity; /* mu, Pa s; of a model that varies what it starts from, see BodyViscosity */
  PetscReal tension;   /* sigma, N/m */
} Material;

#define FREE_MOTIONS (2 * DIM) /* of a free body: velocity (m/s), then angular velocity (rad/s) */

typedef struct _p_Body  *Body;
typedef struct _p_Scene *Scene;

/* SceneCreate - a scene in a domain (borrowed, must outlive the scene). Collective. */
PetscErrorCode SceneCreate(Domain domain, Scene *scene);
/* SceneSetFromOptions - reads the bodies, -gravity (m/s2), -gravity_amplitude (m/s2), -gravity_frequency (Hz),
   -central_force_rate (1/s; acceleration -rate^2 x about the origin), -frame_rotation_rate (rad/s),
   -frame_rotation_center (m). Refuses unknown shapes and velocity types, names
   that are not identifiers or appear twice, no body at all, non-positive sizes and densities, negative viscosity or
   tension, a body wholly outside the box, and bodies that overlap (more than rounding; checked on the points of a
   lattice of the particle spacing). Collective. */
PetscErrorCode SceneSetFromOptions(Scene scene);
/* SceneHelp - makes -help list every option that a body can have, with <body> for its name: one block for what all
   bodies share, then one for each shape, each initial velocity field and each type of body. Reads no value and needs no
   scene. Prints nothing without -help. Collective. */
PetscErrorCode SceneHelp(MPI_Comm comm);
PetscErrorCode SceneView(Scene scene, PetscViewer viewer);
PetscErrorCode SceneDestroy(Scene *scene);

/* Not collective from here on. */
PetscInt        SceneCount(Scene scene);                /* number of bodies */
Body            SceneBody(Scene scene, PetscInt index); /* 0 <= index < SceneCount */
const char     *BodyName(Body body);
const Material *BodyMaterial(Body body);
/* BodyViscosity - mu (Pa s) at a shear rate sqrt(2 D:D) (1/s). BodyViscosityVaries, SceneViscosityVaries - whether it
   depends on it. BodyViscosityModel - the name of -<b>_viscosity_model. */
PetscReal   BodyViscosity(Body body, PetscReal rate);
PetscBool   BodyViscosityVaries(Body body);
const char *BodyViscosityModel(Body body);
PetscBool   SceneViscosityVaries(Scene scene);
PetscInt    BodyColor(Body body);                    /* integer label for pictures; default: the body's index */
PetscInt    SceneSolidCount(Scene scene);            /* number of solids */
Body        SceneSolid(Scene scene, PetscInt index); /* 0 <= index < SceneSolidCount; has no material */
/* BodyContactAngle - of a solid -<s>_contact_angle (degrees), 0 if it has none. BodyContactHysteresis - its
   -<s>_contact_hysteresis (degrees). */
PetscReal BodyContactHysteresis(Body solid);
PetscReal BodyContactAngle(Body solid);
/* SceneSolidDistance - signed distance of x (m) to the nearest solid or image of one through a periodic face, negative
   inside; PETSC_MAX_REAL without any.
 *nearest (may be NULL): its index. */
PetscReal SceneSolidDistance(Scene scene, const PetscReal x[DIM], PetscInt *nearest);
/* SceneSolidNormal - unit vector n out of the nearest solid at x (m), by differences of the distance; zero where that
   is flat. */
void SceneSolidNormal(Scene scene, const PetscReal x[DIM], PetscReal n[DIM]);
/* BodyMoves - whether a solid moves; BodyMovesAs - whether it moves as another one does. BodyMove - moves a point of
   the solid from its place x (m) at one time (s) to its place at another. BodyMotion - the velocity v (m/s) of its
   point that is at x (m) at the time; zero if it does not move. */
PetscBool BodyMoves(Body solid);
PetscBool BodyMovesAs(Body solid, Body other);
void      BodyMove(Body solid, PetscReal from, PetscReal to, PetscReal x[DIM]);
void      BodyMotion(Body solid, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]);
/* SceneSolidsMove - whether any solid does. SceneMoveSolids - puts all where they are at the time (s), 0 at first:
   distances and normals are so from here on. SceneSolidTime - that time. SceneSolidSpeed - no point of any solid is
   ever faster than this (m/s). */
PetscBool SceneSolidsMove(Scene scene);
void      SceneMoveSolids(Scene scene, PetscReal time);
PetscReal SceneSolidTime(Scene scene);
PetscReal SceneSolidSpeed(Scene scene);
/* Free bodies, solids with -<s>_mass. SceneHasFree - whether there is one. BodyMass - its mass (kg; kg/m in two
   dimensions), 0 of any other solid. FreeMotion - centre of mass (m) and velocities of a free body, at the time set
   last by SceneMoveSolids. FreeResponse - by how much an impulse (N s; behind it N m s, about the centre) changes them,
   as the body lies at that time. FreePush - gives it that impulse at the time, which must be that one: from then on it
   moves on with its new velocity. FreeForces - room for the force (N) and torque (N m) of the liquid's pressure in the
   step before, and by how much they exceeded those of the projection: the stepper's, kept with the body.
   FreeAdd - adds a force (N) at x (m) and its torque about the centre to a sum; normal: of the
   surface there, along which a pressure acts, so that it turns no circle (NULL: of all of the force). FreeTurned - axis
   times angle (rad) by which it has turned at its last push. FreeKinetic - its kinetic energy (J). FreeNumbers - all
   that changes of it, as numbers, for a checkpoint. FreeStart - at the start: its centre (m) and moments of inertia
   about x, y and z (kg m2, 0 if it does not turn), and whether it may turn. SceneSolidsAtStart - puts all solids where
   they were at the start. SceneStart - the time (s) of the start, at which free bodies begin to move. SceneFreeze -
   whether they stay where they are for now; let go, they begin without forces of a step before. SceneDriven - whether a
   solid moves that is not free. SceneSave, SceneRestore - saves what a step changes of free
   bodies, at its start, and returns to it. */
PetscBool  SceneHasFree(Scene scene);
PetscReal  BodyMass(Body solid);
void       FreeMotion(Body solid, PetscReal center[DIM], PetscReal motion[FREE_MOTIONS]);
void       FreeResponse(Body solid, const PetscReal impulse[FREE_MOTIONS], PetscReal change[FREE_MOTIONS]);
void       FreePush(Body solid, PetscReal time, const PetscReal impulse[FREE_MOTIONS]);
void       FreeForces(Body solid, PetscReal **force, PetscReal **excess);
void       FreeAdd(Body solid, const PetscReal x[DIM], const PetscReal force[DIM], const PetscReal normal[],
                   PetscReal sum[FREE_MOTIONS]);
void       FreeTurned(Body solid, PetscReal angle[DIM]);
PetscReal  FreeKinetic(Body solid);
PetscReal *FreeNumbers(Body solid, PetscInt *count);
void       FreeStart(Body solid, PetscReal center[DIM], PetscReal inertia[DIM], PetscBool *turns);
void       SceneSolidsAtStart(Scene scene);
void       SceneStart(Scene scene, PetscReal time);
void       SceneFreeze(Scene scene, PetscBool frozen);
PetscBool  SceneDriven(Scene scene);
void       SceneSave(Scene scene);
void       SceneRestore(Scene scene);
/* SceneSpacing - the particle spacing (m) that is wanted at x (m): -spacing in the regions of -fine, growing with the
   distance from them by -spacing_growth, at most -spacing_coarse. Not collective. */
PetscReal SceneSpacing(Scene scene, const PetscReal x[DIM]);
/* SceneNames, SceneName - of all that has options of a body: bodies, then solids, then regions of -fine. */
PetscInt    SceneNames(Scene scene);
const char *SceneName(Scene scene, PetscInt index);
/* BodyDistance - signed distance of x (m) to the surface of the shape, negative inside; the box is not part of it. */
PetscReal BodyDistance(Body body, const PetscReal x[DIM]);
/* BodyNearest - that to the nearest of its images through periodic faces, and y (m), the image of x that is as far from
 * the body itself. x must be in the box. */
PetscReal BodyNearest(Body body, const PetscReal x[DIM], PetscReal y[DIM]);
/* BodyContains - whether x (m) is inside the shape and inside the box. */
PetscBool BodyContains(Body body, const PetscReal x[DIM]);
/* BodyBounds - a box (m) that holds shape and box's intersection. */
void BodyBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM]);
/* SceneBodyScales - of body b, sampled in the box around it: its extents (m) and the least of them that the dimension
   has, with what symmetry faces mirror, the largest initial speed (m/s) and size of each component of the body force
   (m/s2). */
typedef struct {
  PetscReal extent[DIM], length, speed, acceleration[DIM];
} BodyScales;
void SceneBodyScales(Scene scene, PetscInt b, BodyScales *scales);
/* BodyDisplace - moves a point x (m) of a lattice to where it is in the body: a map that keeps volumes and takes the
   layers of the lattice to layers along a curved surface. The identity for most shapes. */
void BodyDisplace(Body body, PetscReal x[DIM]);
/* BodyVelocity - the initial velocity v (m/s) at x (m). */
void BodyVelocity(Body body, const PetscReal x[DIM], PetscReal v[DIM]);
/* BodyEmits - whether the body is an emitter. BodyEmissions - how many times it has been filled up to and at the time
   (s). BodyEmissionShift - how far (m, along x) liquid of emission number k, from 0 on, has moved by then if it moved
   with the emitter's velocity. BodyEmissionVelocity - that velocity v (m/s) at x (m). BodyHolds - whether liquid of the
   body at x (m) still moves with an emitter: no further than its nozzle and 'behind' (m) downstream of its shape. */
PetscBool BodyEmits(Body body);
PetscInt  BodyEmissions(Body body, PetscReal time);
void      BodyEmissionShift(Body body, PetscInt k, PetscReal time, PetscReal shift[DIM]);
void      BodyEmissionVelocity(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]);
PetscBool BodyHolds(Body body, const PetscReal x[DIM], PetscReal behind);
/* SceneEmits - whether any body is an emitter. */
PetscBool SceneEmits(Scene scene);
/* SceneSetTime - the time (s) at which gravity is asked for from here on: it may swing. */
void SceneSetTime(Scene scene, PetscReal time);
/* SceneShaking - the part of gravity that swings, at that time (m/s2). */
void SceneShaking(Scene scene, PetscReal shake[DIM]);
/* SceneFrameTurns - whether the scene is seen in a frame that turns. SceneFrameRate - how fast (rad/s). */
PetscBool SceneFrameTurns(Scene scene);
void      SceneFrameRate(Scene scene, PetscReal rate[DIM]);
/* SceneAcceleration - gravity, central and centrifugal force g (m/s2) at x (m). SceneForcePotential - its potential
   energy a unit mass (J/kg), without the part that swings. */
void      SceneAcceleration(Scene scene, const PetscReal x[DIM], PetscReal g[DIM]);
PetscReal SceneForcePotential(Scene scene, const PetscReal x[DIM]);
/* SceneHasViscosity, SceneHasTension - whether any body has one: modules nobody needs are skipped. */
PetscBool SceneHasViscosity(Scene scene);
PetscBool SceneHasTension(Scene scene);
/* Two liquids that do not mix. SceneInterfaceTension - sigma (N/m) of their interface; 0: there is none.
   SceneInterfaceDensity - the least densities (kg/m3) on both sides added: what its waves move. SceneLiquid - 0 or 1,
   which of them a body is; 0 without an interface. SceneTensions - the tension of each pair of liquid 0, liquid
   1 and gas as the sum of the parts of both (N/m), of which one may be negative. */
PetscReal SceneInterfaceTension(Scene scene);
/* SceneInterfaceBodies - the names of the bodies of liquid 1, separated by commas. */
PetscErrorCode SceneInterfaceBodies(Scene scene, char names[], size_t length);
PetscReal      SceneInterfaceDensity(Scene scene);
PetscInt       SceneLiquid(Scene scene, PetscInt body);
void           SceneTensions(Scene scene, PetscReal part[3]);
/* SceneBodiesOverlap - whether bodies may: a place in several is that of the first. SceneFreeDistance - signed distance
   of x (m) to the surface of what a body then has, negative inside. */
PetscBool SceneBodiesOverlap(Scene scene);
PetscReal SceneFreeDistance(Scene scene, PetscInt body, const PetscReal x[DIM]);
/* SceneOneDensity - whether all bodies have the same rest density. */
PetscBool SceneOneDensity(Scene scene);

#endif
