/* The class: its options and its reports. */
#include "spectrum_impl.h"

PetscErrorCode SpectrumCreate(Cloud cloud, Tension tension, Pressure pressure, Spectrum *spectrum)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(spectrum));
  (*spectrum)->cloud    = cloud;
  (*spectrum)->tension  = tension;
  (*spectrum)->pressure = pressure;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-spectrum",
   "Report eigenvalues and condition of the pressure operator and the stability limits of the explicit terms at the "
   "end of the run",
   NULL, NULL, ROW_BOOL, offsetof(struct _p_Spectrum, wanted)},
  {.name = NULL},
};

PetscErrorCode SpectrumSetFromOptions(Spectrum s)
{
  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(s->cloud->comm, "Spectrum", options, __func__, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool SpectrumWanted(Spectrum spectrum)
{
  return spectrum->wanted;
}

PetscErrorCode SpectrumRun(Spectrum s, const SpectrumStep *step)
{
  Cloud cloud = s->cloud;

  PetscFunctionBegin;
  s->viscosity = step->viscosity;
  PetscCall(SlepcInitialize(NULL, NULL, NULL, NULL));
  PetscCall(PetscMalloc1(DIM * cloud->n_owned, &s->position));
  PetscCall(PetscArraycpy(s->position, cloud->field[FIELD_POSITION], DIM * cloud->n_owned));
  PetscCall(PetscPrintf(cloud->comm, "Spectrum\n"));
  ProgressBegin("the spectrum", "the run before it is complete");
  PetscCall(PressureSetUp(s->pressure, step->dt));
  PetscCall(SpectrumPoisson(s, step->iterations));
  PetscCall(SpectrumLimits(s, step->dt));
  PetscCall(SpectrumModes(s));
  PetscCall(PetscFree(s->position));
  PetscCall(PressureReset(s->pressure));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpectrumDestroy(Spectrum *spectrum)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*spectrum));
  PetscFunctionReturn(PETSC_SUCCESS);
}
