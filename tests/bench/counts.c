/* Counts what a program says to others by MPI: preloaded before it, by tests/bench/counts.py. Rank 0 appends a line to
   the file of COUNTS: messages, their bytes and collectives of the rank with the most of each, and sums over ranks. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { MESSAGES, BYTES, COLLECTIVES, COUNTS };
static double count[COUNTS];

static void Message(int n, MPI_Datatype type)
{
  int size;

  PMPI_Type_size(type, &size);
  count[MESSAGES]++;
  count[BYTES] += (double)n * size;
}

#define SENDS(name)                                                                                                    \
  int name(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c)                                          \
  {                                                                                                                    \
    Message(n, t);                                                                                                     \
    return P##name(b, n, t, to, tag, c);                                                                               \
  }
SENDS(MPI_Send)
SENDS(MPI_Ssend)

#define ISENDS(name)                                                                                                   \
  int name(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request *r)                          \
  {                                                                                                                    \
    Message(n, t);                                                                                                     \
    return P##name(b, n, t, to, tag, c, r);                                                                            \
  }
ISENDS(MPI_Isend)
ISENDS(MPI_Issend)

/* Persistent requests: what they hold is known when they are made. */
#define KEPT 65536
static struct {
  MPI_Request request;
  double      bytes;
} kept[KEPT];
static int next;

int MPI_Send_init(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request *r)
{
  int size, code = PMPI_Send_init(b, n, t, to, tag, c, r);

  PMPI_Type_size(t, &size);
  kept[next].request = *r;
  kept[next].bytes   = (double)n * size;
  next               = (next + 1) % KEPT;
  return code;
}

static void Started(MPI_Request r)
{
  for (int k = KEPT; k > 0; k--) { /* the newest first: handles are used again */
    const int at = (next + k - 1) % KEPT;

    if (!kept[at].request) return;
    if (kept[at].request != r) continue;
    count[MESSAGES]++;
    count[BYTES] += kept[at].bytes;
    return;
  }
}

int MPI_Start(MPI_Request *r)
{
  Started(*r);
  return PMPI_Start(r);
}

int MPI_Startall(int n, MPI_Request r[])
{
  for (int k = 0; k < n; k++) Started(r[k]);
  return PMPI_Startall(n, r);
}

/* PETSc calls collectives of communicators of one rank, too, which say nothing. */
static int Several(MPI_Comm c)
{
  int size;

  PMPI_Comm_size(c, &size);
  return size > 1;
}

#define COLLECTIVE(name, parameters, arguments)                                                                        \
  int name parameters                                                                                                  \
  {                                                                                                                    \
    count[COLLECTIVES] += Several(c);                                                                                  \
    return P##name arguments;                                                                                          \
  }
COLLECTIVE(MPI_Allreduce, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (s, r, n, t, o, c))
COLLECTIVE(MPI_Iallreduce, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c, MPI_Request *q),
           (s, r, n, t, o, c, q))
COLLECTIVE(MPI_Reduce, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op o, int root, MPI_Comm c),
           (s, r, n, t, o, root, c))
COLLECTIVE(MPI_Bcast, (void *b, int n, MPI_Datatype t, int root, MPI_Comm c), (b, n, t, root, c))
COLLECTIVE(MPI_Barrier, (MPI_Comm c), (c))
COLLECTIVE(MPI_Ibarrier, (MPI_Comm c, MPI_Request *q), (c, q))
COLLECTIVE(MPI_Scan, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (s, r, n, t, o, c))
COLLECTIVE(MPI_Exscan, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (s, r, n, t, o, c))
COLLECTIVE(MPI_Gather, (const void *s, int n, MPI_Datatype t, void *r, int m, MPI_Datatype u, int root, MPI_Comm c),
           (s, n, t, r, m, u, root, c))
COLLECTIVE(MPI_Allgather, (const void *s, int n, MPI_Datatype t, void *r, int m, MPI_Datatype u, MPI_Comm c),
           (s, n, t, r, m, u, c))
COLLECTIVE(MPI_Allgatherv,
           (const void *s, int n, MPI_Datatype t, void *r, const int m[], const int d[], MPI_Datatype u, MPI_Comm c),
           (s, n, t, r, m, d, u, c))
COLLECTIVE(MPI_Alltoall, (const void *s, int n, MPI_Datatype t, void *r, int m, MPI_Datatype u, MPI_Comm c),
           (s, n, t, r, m, u, c))
COLLECTIVE(MPI_Reduce_scatter_block, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c),
           (s, r, n, t, o, c))

int MPI_Finalize(void)
{
  double most[COUNTS], sum[COUNTS];
  int    rank, size;

  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  PMPI_Comm_size(MPI_COMM_WORLD, &size);
  PMPI_Reduce(count, most, COUNTS, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
  PMPI_Reduce(count, sum, COUNTS, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
  if (!rank) {
    FILE *file = fopen(getenv("COUNTS"), "a");

    for (int k = 0; k < COUNTS && file; k++) fprintf(file, "%.0f %.0f ", most[k], sum[k] / size);
    if (file) fprintf(file, "\n");
    if (file) fclose(file);
  }
  return PMPI_Finalize();
}
