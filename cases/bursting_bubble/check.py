import os,sys
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np, physics
T=[];Y=[];V=[];O=[]
for time, head, f in physics.snapshots(sys.argv[1]):
    x=f["position"]; d=float(head["spacing"]); n=x[:,0]<3*d
    k=np.flatnonzero(n)[x[n,1].argmax()]
    T.append(time);Y.append(x[k,1]);V.append(f["velocity"][k,1]);O.append(x[n,1].max())
T,Y,V=map(np.array,(T,Y,V))
for i in range(0,len(T),2): print("%.2e y %.4f mm v %.3f m/s"%(T[i],1e3*Y[i],V[i]))
