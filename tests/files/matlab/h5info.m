% h5info(FILE, GROUP) of MATLAB as far as the page uses it, for Octave, which reads HDF5 by `load` alone.
function info = h5info(file, group)
  run = load('-hdf5', file);
  info.Datasets = struct('Name', fieldnames(run.(group(2:end))));
end
