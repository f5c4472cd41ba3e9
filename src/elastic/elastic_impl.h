/* Private to elastic/: polymers dissolved in a liquid, which the flow stretches; the liquid's viscosity is that of the
   solvent. A particle carries the conformation c of its polymers, as FIELD_STRETCH = c - 1:

     dc/dt = L c + c L^T - (f c - 1)/lambda [- alpha (c - 1)^2/lambda],   tau = G (f c - 1)

   oldroyd_b  f = 1          giesekus  f = 1, with the last term          fene_p  f = (b - 3)/(b - tr c)

   L is the gradient that a fit to the velocities finds. What it does not see, velocities that alternate from particle
   to particle, would be driven by tau without resistance. So pairs have a viscosity mu_b besides (ElasticBalance), and
   the force that it gives to the velocities of the fit, which a pair knows, is taken off: a linear velocity has none of
   it, pair by pair, at free surfaces and walls, too. The idea is that of both-sides diffusion and of DEVSS (Guenette
   and Fortin 1995). Where particles pass each other, what the stretch of one differs by from that around it grows
   without end, as in a fluid that carries without diffusion: at Wi 100 all flow is lost. So it mixes with that around
   (ElasticMix), which a linear stretch does not feel. With implicit viscosity mu_b holds waves of the stress in steps
   that are too long for them. */
#ifndef ISPH_ELASTIC_IMPL_H
#define ISPH_ELASTIC_IMPL_H

#include "../gauges/columns.h"
#include "../stepper/edge.h"

typedef enum { OLDROYD_B, GIESEKUS, FENE_P } PolymerModel;

/* What a body has of polymers, a property. */
typedef struct {
  PetscReal modulus;    /* G, Pa; 0: none */
  PetscReal relaxation; /* lambda, s */
  int       model;      /* PolymerModel */
  PetscReal mobility;   /* alpha of giesekus, 1 */
  PetscReal extent;     /* b of fene_p, 1 */
} Polymers;

extern const Property  ElasticProperties[];
extern const GaugeKind GaugeElastic;

/* PolymersOf - of a body of the scene. PolymersAlike - whether two are the same. ElasticOn - whether a scene has
   polymers. Not collective. */
const Polymers *PolymersOf(Scene scene, PetscInt body);
PetscBool       PolymersAlike(const Polymers *p, const Polymers *q);
PetscBool       ElasticOn(Scene scene, Tension tension);

/* --- model.c: one particle; s = c - 1, xx yy zz xy xz yz. Not collective --- */

/* PolymersStretch - s after a time (s) in the gradient L (1/s); c stays positive. PolymersStress - tau (Pa).
   PolymersEnergy - J/m3. PolymersStiffness - a bound of density times the squared speed of a wave of the stress, Pa,
   and the time (s) in which the stress relaxes. */
void      PolymersStretch(const Polymers *p, PetscReal L[DIM][DIM], PetscReal time, PetscReal s[6]);
void      PolymersStress(const Polymers *p, const PetscReal s[6], PetscReal tau[6]);
PetscReal PolymersEnergy(const Polymers *p, const PetscReal s[6]);
PetscReal PolymersStiffness(const Polymers *p, const PetscReal s[6], PetscReal *relaxation);

/* --- stress.c --- */

/* ElasticSolenoidal - takes the divergence off the gradients L ([n_fluid][9], 1/s): the liquid has none. Near the
   surface the derivative along n (OperatorsSmoothNormals) is the uncertain one. Not collective.
   ElasticMix - mixes FIELD_STRETCH of a particle with that of like neighbours less its slope: in a unit of shear of the
   gradients L ([n_fluid][9], 1/s), in which it gets new neighbours, wholly; time (s). Collective.
   ElasticDivergence - force ([n_fluid][3], N/m3) = div T of stresses ([n_total][6], Pa), no stress on the free surface;
   conserves momentum but for what walls take, which is added to wall ([n_total][3], N). Collective. */
void           ElasticSolenoidal(Cloud cloud, const PetscReal n[], PetscReal L[]);
PetscErrorCode ElasticMix(Cloud cloud, const PetscReal L[], PetscReal time);
PetscErrorCode ElasticDivergence(Cloud cloud, const PetscReal n[], const PetscReal T[], PetscReal force[],
                                 PetscReal wall[]);
/* ElasticSeen - out ([n_fluid][3], m/s2): minus what the shares ([n_total], 1) of the viscosity do to the velocities of
   the fit L ([n_fluid][9], 1/s). pair: of OperatorsViscosityPairs. wall: as above. Collective. */
PetscErrorCode ElasticSeen(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[], const PetscReal share[],
                           const PetscReal L[], PetscReal out[], PetscReal wall[]);

#endif
