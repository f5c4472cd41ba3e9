/* Assembly of Eq. (8), straight into compressed rows. */
#include "pressure_impl.h"

PetscErrorCode MatrixStoreReset(MatrixStore *s)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&s->A));
  PetscCall(PetscFree(s->i));
  PetscCall(PetscFree(s->oi));
  PetscCall(PetscFree(s->j));
  PetscCall(PetscFree(s->a));
  PetscCall(PetscFree(s->oj));
  PetscCall(PetscFree(s->oa));
  PetscCall(PetscMemzero(s, sizeof(*s)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SystemChildren(Pressure pressure)
{
  Cloud     cloud = pressure->cloud;
  PetscInt *place;

  PetscFunctionBegin;
  if (pressure->child_layout == cloud->layout) PetscFunctionReturn(PETSC_SUCCESS);
  pressure->child_layout = cloud->layout;
  PetscCall(PetscFree(pressure->child_first));
  PetscCall(PetscFree(pressure->child));
  PetscCall(PetscCalloc1(cloud->n_rows + 1, &pressure->child_first));
  PetscCall(PetscMalloc1(cloud->n_owned - cloud->n_rows, &pressure->child));
  PetscCall(PetscMalloc1(cloud->n_rows, &place));
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++)
    pressure->child_first[cloud->row[a] - cloud->row_start + 1]++;
  for (PetscInt r = 0; r < cloud->n_rows; r++) {
    pressure->child_first[r + 1] += pressure->child_first[r];
    place[r] = pressure->child_first[r];
  }
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++)
    pressure->child[place[cloud->row[a] - cloud->row_start]++] = a;
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SystemColumns(Pressure pressure)
{
  Cloud    cloud = pressure->cloud;
  PetscInt end = cloud->row_start + cloud->n_rows, off = 0, count;

  PetscFunctionBegin;
  if (pressure->layout == cloud->layout && pressure->halo_builds == cloud->halo_builds)
    PetscFunctionReturn(PETSC_SUCCESS);
  if (cloud->n_total > pressure->column_capacity) {
    pressure->column_capacity = cloud->capacity;
    PetscCall(PetscFree(pressure->column));
    PetscCall(PetscFree(pressure->off_row));
    PetscCall(PetscFree(pressure->mark));
    PetscCall(PetscFree(pressure->slot));
    PetscCall(PetscMalloc1(pressure->column_capacity, &pressure->column));
    PetscCall(PetscMalloc1(pressure->column_capacity, &pressure->off_row));
    PetscCall(PetscMalloc1(pressure->column_capacity, &pressure->mark));
    PetscCall(PetscMalloc1(pressure->column_capacity, &pressure->slot));
  }
  for (PetscInt b = 0; b < cloud->n_total; b++)
    if (cloud->row[b] < cloud->row_start || cloud->row[b] >= end) pressure->off_row[off++] = cloud->row[b];
  count = off;
  PetscCall(PetscSortRemoveDupsInt(&count, pressure->off_row));
  pressure->off_count = off ? count : 0;
  for (PetscInt b = 0; b < cloud->n_total; b++) {
    if (cloud->row[b] >= cloud->row_start && cloud->row[b] < end)
      pressure->column[b] = cloud->row[b] - cloud->row_start;
    else {
      PetscInt place;

      PetscCall(PetscFindInt(cloud->row[b], pressure->off_count, pressure->off_row, &place));
      pressure->column[b] = cloud->n_rows + place;
    }
  }
  pressure->layout      = cloud->layout;
  pressure->halo_builds = cloud->halo_builds;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Member m of row r: the particle itself, then its deeper wall particles; -1 behind the last. */
static inline PetscInt RowMember(Pressure pressure, PetscInt r, PetscInt m)
{
  if (m == 0) return r;
  return pressure->child_first[r] + m - 1 < pressure->child_first[r + 1]
           ? pressure->child[pressure->child_first[r] + m - 1]
           : -1;
}

/* First pass: the number of entries a row. The pattern is symmetric; visiting row r, column c counts entry (c, r), as
 * the second pass writes it. */
static PetscErrorCode CountEntries(Pressure pressure, MatrixStore *s)
{
  Cloud           cloud = pressure->cloud;
  const PetscInt *layer = cloud->integer[INT_LAYER], *column = pressure->column, n = cloud->n_rows;
  PetscInt       *mark = pressure->mark;

  PetscFunctionBegin;
  if (n + 1 > s->rows_capacity) {
    s->rows_capacity = n + n / 8 + 1;
    PetscCall(PetscFree(s->i));
    PetscCall(PetscFree(s->oi));
    PetscCall(PetscMalloc1(s->rows_capacity, &s->i));
    PetscCall(PetscMalloc1(s->rows_capacity, &s->oi));
  }
  PetscCall(PetscArrayzero(s->i, n + 1));
  PetscCall(PetscArrayzero(s->oi, n + 1));
  for (PetscInt c = 0; c < n + pressure->off_count; c++) mark[c] = -1;
  for (PetscInt r = 0; r < n; r++) {
    s->i[r + 1]++; /* the diagonal */
    for (PetscInt m = 0, a; (a = RowMember(pressure, r, m)) >= 0; m++)
      for (PetscInt k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
        const PetscInt b = cloud->list[k], c = column[b];

        if (mark[c] == r || c == r || (layer[a] && layer[b])) continue;
        mark[c] = r;
        if (c < n)
          s->i[c + 1]++;
        else
          s->oi[r + 1]++;
      }
  }
  for (PetscInt r = 0; r < n; r++) {
    s->i[r + 1] += s->i[r];
    s->oi[r + 1] += s->oi[r];
  }
  if (s->i[n] > s->capacity) {
    s->capacity = s->i[n] + s->i[n] / 16;
    PetscCall(PetscFree(s->j));
    PetscCall(PetscFree(s->a));
    PetscCall(PetscMalloc1(s->capacity, &s->j));
    PetscCall(PetscMalloc1(s->capacity, &s->a));
  }
  if (s->oi[n] > s->o_capacity) {
    s->o_capacity = s->oi[n] + s->oi[n] / 8;
    PetscCall(PetscFree(s->oj));
    PetscCall(PetscFree(s->oa));
    PetscCall(PetscMalloc1(s->o_capacity, &s->oj));
    PetscCall(PetscMalloc1(s->o_capacity, &s->oa));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Second pass: rows are visited in order and each writes its entries (r, c) at the end of row c, so columns come out
   sorted. */
static PetscErrorCode FillEntries(Pressure pressure, MatrixStore *s)
{
  Cloud           cloud = pressure->cloud;
  const PetscInt *layer = cloud->integer[INT_LAYER], *column = pressure->column, n = cloud->n_rows;
  const PetscReal scale = pressure->weight_scale;
  PetscInt       *mark = pressure->mark, *slot = pressure->slot, *tail, *columns, capacity = ROW_CAPACITY;
  PetscReal      *sums;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &tail));
  PetscCall(PetscArraycpy(tail, s->i, n));
  PetscCall(PetscMalloc1(capacity, &columns));
  PetscCall(PetscMalloc1(capacity, &sums));
  for (PetscInt c = 0; c < n + pressure->off_count; c++) mark[c] = -1;
  for (PetscInt r = 0; r < n; r++) {
    const PetscInt  place    = tail[r]++;
    const PetscReal diagonal = pressure->pairs[r] + pressure->closed[r];
    PetscInt        used = 0, off = s->oi[r];

    for (PetscInt m = 0, a; (a = RowMember(pressure, r, m)) >= 0; m++) {
      if (used + cloud->first[a + 1] - cloud->first[a] > capacity) {
        capacity = 2 * capacity;
        PetscCall(PetscRealloc(capacity * sizeof(*columns), &columns));
        PetscCall(PetscRealloc(capacity * sizeof(*sums), &sums));
      }
      for (PetscInt k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
        const PetscInt  b = cloud->list[k], c = column[b];
        const PetscReal K = scale * PairWeight(pressure, k);

        if (c == r || (layer[a] && layer[b])) continue;
        if (mark[c] != r) {
          mark[c]       = r;
          slot[c]       = used;
          columns[used] = c;
          sums[used++]  = K;
        } else
          sums[slot[c]] += K;
      }
    }
    s->j[place] = r;
    s->a[place] = diagonal > 0 ? diagonal : 1;
    for (PetscInt k = 0; k < used; k++) {
      if (columns[k] < n) {
        s->j[tail[columns[k]]]   = r;
        s->a[tail[columns[k]]++] = -sums[k];
      } else {
        s->oj[off]   = pressure->off_row[columns[k] - n];
        s->oa[off++] = -sums[k];
      }
    }
    PetscCall(PetscSortIntWithScalarArray(off - s->oi[r], s->oj + s->oi[r], s->oa + s->oi[r]));
  }
  PetscCall(PetscFree(tail));
  PetscCall(PetscFree(columns));
  PetscCall(PetscFree(sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Hands the arrays to a Mat of the chosen type. */
static PetscErrorCode WrapMatrix(Pressure pressure, MatrixStore *s)
{
  Cloud       cloud = pressure->cloud;
  PetscMPIInt size;
  PetscBool   plain, shell;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(cloud->comm, &size));
  PetscCall(MatDestroy(&s->A));
  if (size == 1)
    PetscCall(MatCreateSeqAIJWithArrays(cloud->comm, cloud->n_rows, cloud->n_rows, s->i, s->j, s->a, &s->A));
  else
    PetscCall(MatCreateMPIAIJWithSplitArrays(cloud->comm, cloud->n_rows, cloud->n_rows, cloud->rows_global,
                                             cloud->rows_global, s->i, s->j, s->a, s->oi, s->oj, s->oa, &s->A));
  PetscCall(PetscStrcmp(pressure->mat_type, MATAIJ, &plain));
  PetscCall(PetscStrcmp(pressure->mat_type, MATSHELL, &shell));
  plain = (PetscBool)(plain || shell || !pressure->mat_type[0]);
  PetscCall(MatSetOption(s->A, MAT_SPD, PETSC_TRUE)); /* some conversions ask for it */
  if (!plain) PetscCall(MatConvert(s->A, pressure->mat_type, MAT_INPLACE_MATRIX, &s->A));
  PetscCall(MatSetOption(s->A, MAT_SPD, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SystemAssemble(Pressure pressure, MatrixStore *s)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&s->A));
  PetscCall(SystemColumns(pressure));
  PetscCall(CountEntries(pressure, s));
  PetscCall(FillEntries(pressure, s));
  PetscCall(WrapMatrix(pressure, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
