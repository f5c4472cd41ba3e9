/* Floor 1: the scene as data. Named bodies of liquid, each a shape with a material and an initial velocity field; body
   forces.

   -bodies film,drop  and, for each body <b>:
   -<b>_shape box|sphere|cylinder|ellipsoid|half_space|wave|thread|stl, its sizes, -<b>_density, -<b>_viscosity,
   -<b>_tension,
   -<b>_viscosity_model newtonian|power_law|carreau|herschel_bulkley and its numbers (viscosity.c),
   -<b>_velocity (uniform part), -<b>_velocity_type uniform|rotation|strain|formula and its numbers (added
   to the uniform part). Every shape is cut by the box and by the solids.

   -<b>_type emitter: the body is empty at the start. Its shape is filled with liquid of the body's velocity every
   _interval (s) from _start (s) on, _count times (0: without end). The default interval is the shape's length along the
   velocity over the speed; then a box or cylinder along it gives a jet without gaps, with the flux of its
   cross-section. Liquid inside the shape keeps the velocity. _modulation e and _modulation_frequency f (Hz): the speed
   is v (1 + e sin 2 pi f t).

   -solids step,ramp  and, for each solid <s>, -<s>_shape and its sizes. Solids have the same no-slip condition as the
   walls of the box. They may touch and overlap each other and the faces of the box. A solid is fixed, or it has a
   prescribed motion (bodies/motion.c): -<s>_velocity, -<s>_oscillation_amplitude, _frequency, _phase,
   -<s>_rotation_rate, _rotation_center, _rotation_axis, _motion_file. Or it is a free body, which the liquid moves
   (bodies/rigid.c): -<s>_mass, _inertia, _turns. Functions about solids refer to the time of the last SceneMoveSolids
   unless they have an argument 'time'.

   -fine core,rim  and, for each region <r>, -<r>_shape and its sizes: the particle spacing is -spacing in these regions
   and grows to -spacing_coarse outside (SceneSpacing).

   -<b>_holes pit,tube of a body or solid: shapes that are cut out of it; a hole is air, or another body fills it.
   _pressure: of the gas in it at the start, with -gas.

   Shapes and their sizes (m):
   box         _lower, _upper (default: the simulation box)
   sphere      _center, _radius; _wave_amplitude, _wave_mode: the shape of an oscillating drop
   cylinder    _center, _radius, _axis x|y|z or a vector, _height (0: infinite)
   ellipsoid   _center, _radii
   half_space  _point, _normal (out of the liquid)
   wave        _lower, _upper (as a box; the last number of _upper is the mean level), _wave_amplitude a, _wave_length
               (along x; a whole number of half waves in the width). The surface is at a cos k(x - x_lower) + k a^2/2
               coth(kH) cos 2k(x - x_lower) from the level, a standing wave to second order. The lattice packing moves
               its points along the velocity field of the linear wave, which conserves volumes, so the amplitude may be
               a fraction of the spacing.
   thread      an infinite cylinder, _center, _radius, _axis, whose radius has waves of _wave_amplitude and
               _wave_length, with a crest at the center; its points move like those of a wave. Needs three dimensions
               or rings.
   stl         a closed surface of triangles from _file, scaled by _scale and moved by _offset. Its distance comes from
               a table with two nodes a spacing, which has errors of some tenths of a spacing at edges. In two
               dimensions its section at z = 0.
   In two dimensions a sphere is a circle, and z is ignored. With rings a shape is the section of a body of revolution:
   a sphere off the axis is a torus, a box a tube, a half-space with an inclined plane a cone. A cylinder must be about
   the axis.

   Velocity fields: rotation _rotation_rate (rad/s), _rotation_center; strain _strain_rate (1/s, diagonal or full
   gradient), _strain_center; formula _velocity_formula. */
#ifndef ISPH_SCENE_H
#define ISPH_SCENE_H

#include "../domain/domain.h"

#define SCENE_MAX_BODIES 64

typedef struct {
  PetscReal density;   /* rho_0, kg/m3 */
  PetscReal viscosity; /* mu, Pa s, or the parameter K of the viscosity model, see viscosity.c */
  PetscReal tension;   /* sigma, N/m */
} Material;

typedef struct _p_Body  *Body;
typedef struct _p_Scene *Scene;

/* SceneCreate - an empty scene in a domain, which is borrowed and must outlive the scene. Collective. */
PetscErrorCode SceneCreate(Domain domain, Scene *scene);
/* SceneSetFromOptions - reads the bodies, -gravity (m/s2), -gravity_amplitude (m/s2), -gravity_frequency (Hz),
   -central_force_rate (1/s; acceleration -rate^2 x about the origin), -frame_rotation_rate (rad/s),
   -frame_rotation_center (m). Refuses (UserError) a scene without bodies, unknown shapes and velocity types, names that
   are not identifiers or appear twice, non-positive sizes and densities, a negative viscosity or tension, a body wholly
   outside the box, and bodies that overlap at a point of a lattice of the particle spacing. Collective. */
PetscErrorCode SceneSetFromOptions(Scene scene);
/* SceneHelp - reads every option of a body, with <body> for its name, for -help and the notes: one block for the
   options of all bodies, then one for each shape, viscosity model, initial velocity field and type of body; the
   properties are those of the domain. Collective. */
PetscErrorCode SceneHelp(Domain domain);
PetscErrorCode SceneView(Scene scene, PetscViewer viewer);
/* SceneIdentity - writes the box, the bodies and the solids as lines "-<option> = <value>", with the numbers as they
   were read and with checksums of files: scenes that differ in a line are different scenes. Not collective. */
PetscErrorCode SceneIdentity(Scene scene, FILE *text);
/* SceneJson - writes bodies, solids, regions, interface and forces into the open object of scene.json; the moments at
   which solids are extreme are those from start to end (s). Not collective. */
void           SceneJson(Scene scene, PetscReal start, PetscReal end, Json *json);
PetscErrorCode SceneDestroy(Scene *scene);

/* The functions below are not collective. */
Domain          SceneDomain(Scene scene);
PetscInt        SceneCount(Scene scene);                /* number of bodies */
Body            SceneBody(Scene scene, PetscInt index); /* 0 <= index < SceneCount */
const char     *BodyName(Body body);
const Material *BodyMaterial(Body body);
/* BodyOwn - the data (borrowed) of a property of a body, solid or hole; NULL: it has none. SceneOwn - of the scene.
   SceneFaceOwn - of a face of the box. BodiesAlike - whether two bodies, two solids or two holes are made of the same:
   all rows of their material, of their viscosity or wetting, and of what features give them. */
void     *BodyOwn(Body body, const Property *property);
void     *SceneOwn(Scene scene, const Property *property);
void     *SceneFaceOwn(Scene scene, PetscInt d, PetscInt side, const Property *property);
PetscBool BodiesAlike(Body one, Body other);
/* BodyViscosity - mu (Pa s) at a shear rate sqrt(2 D:D) (1/s). BodyViscosityVaries - whether mu depends on the shear
   rate. SceneViscosityVaries - whether any body's does. */
PetscReal BodyViscosity(Body body, PetscReal rate);
PetscBool BodyViscosityVaries(Body body);
PetscBool SceneViscosityVaries(Scene scene);
PetscInt  SceneSolidCount(Scene scene);            /* number of solids */
Body      SceneSolid(Scene scene, PetscInt index); /* 0 <= index < SceneSolidCount; a solid has no material */
/* SceneSolidDistance - signed distance (m) of x (m) to the nearest solid or periodic image of a solid, negative inside;
   PETSC_MAX_REAL without solids. nearest (may be NULL): the index of that solid. */
PetscReal SceneSolidDistance(Scene scene, const PetscReal x[DIM], PetscInt *nearest);
/* SceneSolidWithin - the same where it is below reach (m), else reach; then nearest is left. Cheap far from solids. */
PetscReal SceneSolidWithin(Scene scene, PetscReal reach, const PetscReal x[DIM], PetscInt *nearest);
/* DistanceNormal - the unit normal n from differences of a signed distance around x (m). Zero where these vanish, as
   far from two surfaces outside; in the middle of a thin shape it is that of one of its faces. which: passed on to the
   distance. SceneOwnDistance and SceneOneDistance, the signed distance of one solid, by its index, are such functions.
 */
typedef PetscReal (*SceneDistance)(Scene scene, PetscInt which, const PetscReal x[DIM]);
PetscReal SceneOneDistance(Scene scene, PetscInt which, const PetscReal x[DIM]);
void      DistanceNormal(Scene scene, SceneDistance distance, PetscInt which, const PetscReal x[DIM], PetscReal n[DIM]);
/* SceneSolidNormal - unit normal n at x (m) out of the nearest solid, from differences of the signed distance; zero
   where these vanish. */
void SceneSolidNormal(Scene scene, const PetscReal x[DIM], PetscReal n[DIM]);
/* BodyMoves - whether a solid can move. BodyMotion - the velocity v (m/s) of the solid's point at x (m) at a time (s);
   zero for a fixed solid. */
PetscBool BodyMoves(Body solid);
void      BodyMotion(Body solid, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]);
/* SceneSolidVelocity - the velocity v (m/s) of a solid, by its index, at its point nearest to x (m). SceneSolidsMove -
   whether any solid can move. SceneMoveSolids - moves all solids to their positions at a time (s); they start at the
   time 0. SceneSolidTime - that time. SceneSolidSpeed - an upper bound of the speed of all points of all solids (m/s).
 */
void      SceneSolidVelocity(Scene scene, PetscInt solid, const PetscReal x[DIM], PetscReal v[DIM]);
PetscBool SceneSolidsMove(Scene scene);
void      SceneMoveSolids(Scene scene, PetscReal time);
PetscReal SceneSolidTime(Scene scene);
PetscReal SceneSolidSpeed(Scene scene);
/* SceneSpacing - the graded particle spacing (m) at x (m): -spacing plus -spacing_growth times the distance from the
   regions of -fine, at most -spacing_coarse; at most what adapts it wants there. */
PetscReal SceneSpacing(Scene scene, const PetscReal x[DIM]);
/* BodyDistance - signed distance (m) of x (m) to the surface of the shape, negative inside. The box does not cut the
   shape here. */
PetscReal BodyDistance(Body body, const PetscReal x[DIM]);
/* BodyNearest - signed distance (m) of x (m), in the box, to the nearest periodic image of the body. y (m): the image
   of x at that distance from the body itself. */
PetscReal BodyNearest(Body body, const PetscReal x[DIM], PetscReal y[DIM]);
/* BodyContains - whether x (m) is inside the shape and the box. */
PetscBool BodyContains(Body body, const PetscReal x[DIM]);
/* SceneHole - hole k of all bodies and solids; NULL: there are only k. SceneHoleAt - the first one at x (m); where none
   is, one of no body, with the defaults of a hole's properties: the open air. */
Body SceneHole(Scene scene, PetscInt k);
Body SceneHoleAt(Scene scene, const PetscReal x[DIM]);
/* BodyBounds - bounds (m) of the intersection of shape and box. */
void BodyBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM]);
/* SceneBodyThinnest - the thickness of body b or of a hole in it: the least extent including mirror images at symmetry
   faces (m), of an emitter across its velocity. SceneBodyScales - its extents (m), its thickness (m), and the largest
   initial speed (m/s) and acceleration along each axis (m/s2), both sampled within the bounds. Boxes of one liquid that
   are one box, cut in two, have the extents of the whole. */
typedef struct {
  PetscReal extent[DIM], length, speed, acceleration[DIM];
} BodyScales;
PetscReal SceneBodyThinnest(Scene scene, PetscInt b);
void      SceneBodyScales(Scene scene, PetscInt b, BodyScales *scales);
/* SceneNumbers - the dimensionless numbers of body b, with its thickness L (m), its largest initial speed U (m/s) and
   its viscosity at the shear rate U/L (Pa s): Re = rho U L/mu, We = rho U^2 L/sigma, Fr = U^2/(g L),
   Bo = rho g L^2/sigma, Oh = mu/sqrt(rho sigma L), Ca = mu U/sigma; each is 'above' over 'below', NAN if one is 0. */
enum { NUMBER_REYNOLDS, NUMBER_WEBER, NUMBER_FROUDE, NUMBER_BOND, NUMBER_OHNESORGE, NUMBER_CAPILLARY, SCENE_NUMBERS };
typedef struct {
  const char *name;
  PetscReal   above, below, value;
} DimensionlessNumber;
typedef struct {
  PetscReal           length, speed, viscosity;
  DimensionlessNumber number[SCENE_NUMBERS];
} BodyNumbers;
void SceneNumbers(Scene scene, PetscInt b, BodyNumbers *numbers);
/* SceneMoments - the times (s) from start to end, at most 'most' of them, at which motions of solids, swinging gravity
   and emitters are extreme: rows of a table of motion, the eighths of a period, the first fillings; returns their
   number. 0: nothing in the scene depends on the time. BodyMoments - those of one solid or emitter. SceneFrequency -
   the largest frequency (Hz) at which one of them swings; 0: none does. Not collective. */
PetscInt  SceneMoments(Scene scene, PetscReal start, PetscReal end, PetscInt most, PetscReal moment[]);
PetscInt  BodyMoments(Body body, PetscReal start, PetscReal end, PetscInt most, PetscReal moment[]);
PetscReal SceneFrequency(Scene scene);
/* BodyDisplace - maps a point x (m) of a lattice to a point of the body. The map conserves volumes and bends the
   lattice's layers along a curved surface. The identity for most shapes. */
void BodyDisplace(Body body, PetscReal x[DIM]);
/* BodyVelocity - the initial velocity v (m/s) at x (m). */
void BodyVelocity(Body body, const PetscReal x[DIM], PetscReal v[DIM]);
/* BodyHolds - whether the velocity of the body's liquid at x (m) is given: in a type of body that brings liquid, and up
   to 'behind' (m) downstream of it. BodyComesLater - whether the body has no liquid at the start, since its type brings
   it during the run. SceneComesLater - whether any body has none. */
PetscBool BodyHolds(Body body, const PetscReal x[DIM], PetscReal behind);
/* Of a body that comes later: BodyFillings - the number of its fillings up to and at a time (s). BodyFillingVelocity -
   the velocity v (m/s) of its liquid at x (m). */
PetscInt  BodyFillings(Body body, PetscReal time);
void      BodyFillingVelocity(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]);
PetscBool BodyComesLater(Body body);
PetscBool SceneComesLater(Scene scene);
/* SceneSetTime - sets the time (s) of forces that depend on it. SceneTime - that time; NAN: not yet set. */
void      SceneSetTime(Scene scene, PetscReal time);
PetscReal SceneTime(Scene scene);
/* SceneDrive - the part of the body forces without a potential at x (m) and that time (m/s2), that along periodic
   directions too; whether it is any. */
PetscBool SceneDrive(Scene scene, const PetscReal x[DIM], PetscReal drive[DIM]);
/* SceneFrameTurns - whether the frame of reference rotates. SceneFrameRate - its angular velocity (rad/s). */
PetscBool SceneFrameTurns(Scene scene);
void      SceneFrameRate(Scene scene, PetscReal rate[DIM]);
/* SceneAcceleration - acceleration g (m/s2) of all body forces at x (m): gravity, shaking, central and centrifugal.
   SceneForceUniform - whether it is the same everywhere. SceneForcePotential - the potential (J/kg) of those that have
   one, without SceneDrive. */
void      SceneAcceleration(Scene scene, const PetscReal x[DIM], PetscReal g[DIM]);
PetscBool SceneForceUniform(Scene scene);
PetscReal SceneForcePotential(Scene scene, const PetscReal x[DIM]);
/* SceneHasViscosity, SceneHasTension - whether any body has a viscosity or a surface tension; if not, the step skips
   that part. */
PetscBool SceneHasViscosity(Scene scene);
PetscBool SceneHasTension(Scene scene);
/* Two immiscible liquids. SceneInterfaceTension - sigma (N/m) of their interface; 0: no interface.
   SceneInterfaceDensity - the sum of the least densities (kg/m3) of both liquids, which the dispersion relation of
   capillary waves contains. SceneLiquid - the liquid of a body, 0 or 1; 0 without an interface. SceneTensions - splits
   the tensions into parts of liquid 0, liquid 1 and gas (N/m): the tension of a pair is the sum of both parts. A part
   may be negative. */
PetscReal SceneInterfaceTension(Scene scene);
PetscReal SceneInterfaceDensity(Scene scene);
PetscInt  SceneLiquid(Scene scene, PetscInt body);
void      SceneTensions(Scene scene, PetscReal part[3]);
/* SceneBodiesOverlap - whether bodies may overlap; the first body in -bodies gets the common part. SceneOwnDistance -
   signed distance (m) of x (m) to the surface of a body's shape without the parts that earlier bodies get, negative
   inside. */
PetscBool SceneBodiesOverlap(Scene scene);
PetscReal SceneOwnDistance(Scene scene, PetscInt body, const PetscReal x[DIM]);
/* SceneOneDensity - whether all bodies have the same rest density. */
PetscBool SceneOneDensity(Scene scene);

#endif
